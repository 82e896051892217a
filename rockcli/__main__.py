"""The command `rock`, also as `python -m rockcli`."""

import signal
import sys


def main() -> None:
    """Run the command; an interrupt while its modules are imported, half a second, ends it as any other does."""
    try:
        from rockcli.cli.main import main as command
    except KeyboardInterrupt:
        sys.stderr.write("rock: interrupted\n")
        sys.exit(130)
    try:
        command()
    finally:
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
            signal.signal(signal.SIGINT, signal.SIG_DFL)  # while Python ends it would be a traceback, and no answer


if __name__ == "__main__":
    main()
