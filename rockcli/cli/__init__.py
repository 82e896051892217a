"""The command `rock`: talks to people, one file per command, bodies import what they need."""
