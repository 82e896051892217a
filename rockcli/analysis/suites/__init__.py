"""What a suite (`over`) does: its members, statistics, fragility and risk, as variables of its dataset and in words."""
