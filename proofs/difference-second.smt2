; The same for b - a.
(assert (= defined_f (and defined_a defined_b)))
(assert (= defined_g (and defined_a2 defined_b2)))
(assert (= defined_b2 defined_b))
(assert (= b2 b))
(assert (= f (- b a)))
(assert (= g (- b2 a2)))
(assert (fits defined_a a defined_a2 a2 (- t lo_b) (+ s hi_b)))
(assert (not (fits defined_f f defined_g g s t)))
