//! Curves given by equations, for the laws.

/// One of each kind, plane and in space, whole and in part, in both senses.
pub(crate) const CURVES: &str = r#"
elliptic.ellipse = { radii = [0.4, 3], center = [2, 2], from = 200, to = -40 }
parabola.parabola = { focus = 0.3, vertex = [1, -1], from = -2, to = 0.7 }
falling.parabola = { focus = -2, from = 3, to = 2 }
hyperbola.hyperbola = { radii = [0.4, 2], center = [0, 1], from = -3, to = 5 }
leaning.conic = { form = "ellipse", first = [2, 0, 1], second = [1.7, 0.4, 0.9], center = [1, 1, 1] }
slice.conic = { form = "ellipse", first = [2, 0, 1], second = [-1, 0.4, 0.9], from = 100, to = -77 }
branch.conic = { form = "hyperbola", first = [2, 0, 1], second = [1.9, 0.4, 0.9], from = 1.5, to = -2 }
dish.conic = { form = "parabola", first = [2, 0, 1], second = [1.9, 0.4, 0.9], from = -1.5, to = 0.5 }
"#;
