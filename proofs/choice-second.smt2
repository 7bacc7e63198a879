; The condition has a value throughout, not below 0.
(assert (= defined_f (and defined_q (ite (< q 0.0) defined_a defined_b))))
(assert (= f (ite (< q 0.0) a b)))
(assert (= defined_g defined_b2))
(assert (= g b2))
(assert defined_q)
(assert (>= q 0.0))
(assert (fits defined_b b defined_b2 b2 s t))
(assert (not (fits defined_f f defined_g g s t)))
