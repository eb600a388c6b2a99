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
graph.formula = { y = "= 0.3 * sin(200 * x) + x ^ 2 / 4", from = -2, to = 3 }
radius.formula = { x = "= 1 + 0.2 * cos(90 * y) * exp(-y)", from = 0.5, to = 3 }
knot.formula = { x = "= (2 + cos(3 * t)) * cos(2 * t)", y = "= (2 + cos(3 * t)) * sin(2 * t)", z = "= sin(3 * t)", from = 0, to = 360 }
flower.formula = { r = "= 1 + 0.3 * cos(5 * t)", from = 0, to = 360 }
kinked.formula = { y = "= abs(x - 0.3) + max(x, 2 * x - 1)", from = -1, to = 2 }
switched.formula = { y = "= if(x < 0, x ^ 2, if(x < 1, 2 * x ^ 2, 4 * x - 2))", from = -1, to = 2 }
rooted.formula = { y = "= sqrt(x)", from = 0.2, to = 2 }
cycloid.formula = { x = "= t * pi / 180 - sin(t)", y = "= 1 - cos(t)", from = 0, to = 720 }
hills.formula = { y = "= noise(3, 2 * x, 0.5)", from = 0.2, to = 3.1 }
eased.formula = { y = "= smoothstep(0, 1, x) + clamp(x, -1, 3)", from = -0.5, to = 1.5 }
catenary.formula = { y = "= 0.7 * cosh(x / 0.7)", from = -1, to = 1 }
"#;
