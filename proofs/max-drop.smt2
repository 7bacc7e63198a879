; An operand of a maximum is dropped: it has a value, and is beyond -s.
(assert (= defined_f (and defined_a defined_b)))
(assert (= defined_g defined_a2))
(assert (= g a2))
(assert (= f (most a b)))
(assert defined_b)
(assert (< hi_b (- s)))
(assert (fits defined_a a defined_a2 a2 s t))
(assert (not (fits defined_f f defined_g g s t)))
