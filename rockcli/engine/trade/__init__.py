"""`rock trade`: what accuracy costs, measured over the settings of every backend."""
