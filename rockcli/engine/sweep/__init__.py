"""All cases of a study, in chunks: who solves them, what is kept, how the results are gathered."""
