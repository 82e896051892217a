"""Tables of experiments: read, predicted, scored, calibrated on."""
