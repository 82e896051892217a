"""Bodies that slide, leave the ground, or both while they rock (docs/contact.md)."""
