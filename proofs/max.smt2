; Both operands of a maximum are kept.
(assert (= defined_f (and defined_a defined_b)))
(assert (= defined_g (and defined_a2 defined_b2)))
(assert (= f (most a b)))
(assert (= g (most a2 b2)))
(assert (fits defined_a a defined_a2 a2 s t))
(assert (fits defined_b b defined_b2 b2 s t))
(assert (not (fits defined_f f defined_g g s t)))
