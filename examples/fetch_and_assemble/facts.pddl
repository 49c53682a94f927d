(define (problem fetch) (:domain rover)
  (:objects base ridge crater - Place battery - Battery mug - Mug)
  (:init (rover-at base) (workshop base) (hand-empty) (at battery crater) (at mug ridge))
  (:goal (assembled battery mug)))
