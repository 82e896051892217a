"""The event-driven solver of rigid bodies: one at a time or in lanes, and bodies that slide."""
