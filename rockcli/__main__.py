"""`python -m rockcli`: the command `rock`."""

from rockcli.cli.main import main

if __name__ == "__main__":
    main()
