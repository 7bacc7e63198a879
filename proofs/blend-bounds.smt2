; Bounds of a blend.
(assert (<= 0.0 k))
(assert (<= 0.0 c))
(assert (<= (* c k) 1.0))
(assert defined_a)
(assert defined_b)
(assert (not (within true (blend a b k c) (- (least lo_a lo_b) (* c k k)) (least hi_a hi_b))))
