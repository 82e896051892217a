"""The command `rock`, also as `python -m rockcli`."""

import sys


def main() -> None:
    """Run the command; an interrupt while its modules are imported, half a second, ends it as any other does."""
    try:
        from rockcli.cli.main import main as command
    except KeyboardInterrupt:
        sys.stderr.write("rock: interrupted\n")
        sys.exit(130)
    command()


if __name__ == "__main__":
    main()
