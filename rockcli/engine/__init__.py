"""Runs studies: chooses backends, walks the cases, judges the results, writes them whole or not at all."""
