"""From the numbers of a batch of cases to bodies, motions and the batch that a solver takes."""
