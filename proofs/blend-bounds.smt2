; Bounds of a minimum serve the thresholds of its blend: no blend is above the minimum, and no
; operand below it.
(assert (<= 0.0 k))
(assert (<= 0.0 c))
(assert (<= (* c k) 1.0))
(assert defined_a)
(assert defined_b)
(define-fun lowest () Real (least lo_a lo_b))
(define-fun highest () Real (least hi_a hi_b))
(define-fun t2 () Real (upper s t highest))
(define-fun s2 () Real (lower s t lowest highest))
(define-fun passes ((least_t Real)) Bool
  (=> (fits defined_a a defined_a2 a2 s2 least_t) (fits defined_a a defined_a2 a2 s least_t)))
(assert (not (and (<= (blend a b k c) highest) (passes t2) (passes (+ t2 k)))))
