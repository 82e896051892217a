"""What is read from solved datasets: curves, rules, suites, fragility, comparisons, verdicts on what is expected."""
