; Thresholds need not be beyond bounds of the value.
(assert (within defined_f f lo hi))
(assert (<= lo hi))
(assert (fits defined_f f defined_g g (lower s t lo hi) (upper s t hi)))
(assert (not (fits defined_f f defined_g g s t)))
