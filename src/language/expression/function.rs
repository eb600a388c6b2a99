//! The functions of expressions: names, how many arguments, what they do.

/// A function and the numbers of arguments that it takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Function {
    /// The name.
    pub name: &'static str,
    /// The fewest arguments.
    pub least: usize,
    /// The most arguments.
    pub most: usize,
    /// How it is written, for messages and the reference page.
    pub usage: &'static str,
    /// What it does.
    pub doc: &'static str,
    /// Which one it is.
    pub(crate) call: Call,
}

/// The functions one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Call {
    If,
    Mix,
    Clamp,
    Smoothstep,
    Noise,
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Sinh,
    Cosh,
    Tanh,
    Sqrt,
    Abs,
    Sign,
    Min,
    Max,
    Floor,
    Ceil,
    Round,
    Exp,
    Ln,
    Length,
}

macro_rules! functions {
    ($($call:ident $name:literal $least:literal..=$most:literal $usage:literal $doc:literal;)+) => {
        /// All functions.
        pub const FUNCTIONS: &[Function] = &[$(Function {
            name: $name,
            least: $least,
            most: $most,
            usage: $usage,
            doc: $doc,
            call: Call::$call,
        },)+];
    };
}

functions! {
    If "if" 3..=3 "if(condition, then, else)" "the second or the third, as the first is true or false; only that one is computed";
    Mix "mix" 3..=3 "mix(a, b, t)" "`a` at t = 0, `b` at t = 1, in proportion between and beyond; numbers or points";
    Clamp "clamp" 3..=3 "clamp(x, least, most)" "`x`, but not below `least` and not above `most`";
    Smoothstep "smoothstep" 3..=3 "smoothstep(from, to, x)" "0 below `from`, 1 above `to`, a smooth 3t² - 2t³ between";
    Noise "noise" 3..=3 "noise(seed, x, y)" "smooth random hills from -1 to 1, 0 where x and y are whole; the same on every machine";
    Sin "sin" 1..=1 "sin(degrees)" "sine";
    Cos "cos" 1..=1 "cos(degrees)" "cosine";
    Tan "tan" 1..=1 "tan(degrees)" "tangent";
    Asin "asin" 1..=1 "asin(x)" "angle in degrees whose sine is `x`, from -90 to 90";
    Acos "acos" 1..=1 "acos(x)" "angle in degrees whose cosine is `x`, from 0 to 180";
    Atan "atan" 1..=1 "atan(x)" "angle in degrees whose tangent is `x`, from -90 to 90";
    Atan2 "atan2" 2..=2 "atan2(y, x)" "angle in degrees of the point [x, y], from -180 to 180";
    Sinh "sinh" 1..=1 "sinh(x)" "hyperbolic sine";
    Cosh "cosh" 1..=1 "cosh(x)" "hyperbolic cosine: a hanging chain is a * cosh(x / a)";
    Tanh "tanh" 1..=1 "tanh(x)" "hyperbolic tangent";
    Sqrt "sqrt" 1..=1 "sqrt(x)" "square root";
    Abs "abs" 1..=1 "abs(x)" "size without sign";
    Sign "sign" 1..=1 "sign(x)" "-1, 0 or 1";
    Min "min" 1..=64 "min(a, b, ...)" "the least";
    Max "max" 1..=64 "max(a, b, ...)" "the greatest";
    Floor "floor" 1..=1 "floor(x)" "the whole number at or below";
    Ceil "ceil" 1..=1 "ceil(x)" "the whole number at or above";
    Round "round" 1..=1 "round(x)" "the nearest whole number; halves away from 0";
    Exp "exp" 1..=1 "exp(x)" "e to the power `x`";
    Ln "ln" 1..=1 "ln(x)" "natural logarithm";
    Length "length" 1..=1 "length(point)" "distance of a point from the origin";
}

/// The function of a name.
pub(crate) fn find(name: &str) -> Option<&'static Function> {
    FUNCTIONS.iter().find(|function| function.name == name)
}
