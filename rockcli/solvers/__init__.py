"""Solution methods: one file or folder each, all with `solve(batch) -> Response`."""
