"""What reading many recorded motions takes: their numbers, and what is measured of each."""
