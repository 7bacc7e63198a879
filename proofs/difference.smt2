; The same for a - b.
(assert (= defined_f (and defined_a defined_b)))
(assert (= defined_g (and defined_a2 defined_b2)))
(assert (= defined_b2 defined_b))
(assert (= b2 b))
(assert (= f (- a b)))
(assert (= g (- a2 b2)))
(assert (fits defined_a a defined_a2 a2 (- s lo_b) (+ t hi_b)))
(assert (not (fits defined_f f defined_g g s t)))
