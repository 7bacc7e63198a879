; A restriction of a by a condition on b.
(assert (= defined_f (and defined_a defined_b (> b 0.0))))
(assert (= f a))
(assert (= defined_g (and defined_a2 defined_b2 (> b2 0.0))))
(assert (= g a2))
(assert (fits defined_a a defined_a2 a2 s t))
(assert (fits defined_b b defined_b2 b2 0.0 0.0))
(assert (not (fits defined_f f defined_g g s t)))
