"""One rigid body that rolls from vertex to vertex of a convex outline."""
