//! What each code means, at length, for `kiln explain CODE`.

use crate::language::diagnostic::Code;

/// A code explained.
#[derive(Clone, Copy, Debug)]
pub struct Example {
    /// Why it is an error and what to do.
    pub text: &'static str,
    /// A document that gives the code; empty where none can show it.
    pub wrong: &'static str,
    /// The document put right.
    pub right: &'static str,
}

/// The explanation of a code as a page of Markdown.
#[must_use]
pub fn explain(code: Code) -> String {
    let Example { text, wrong, right } = example(code);
    let mut page = format!("# {code}: {}\n\n{text}\n", code.title());
    for (title, document) in [("Wrong", wrong), ("Right", right)] {
        if !document.is_empty() {
            page.push_str(&format!("\n{title}:\n\n```toml\n{}\n```\n", document.trim()));
        }
    }
    page
}

macro_rules! examples {
    ($($code:ident: $text:literal, $wrong:literal => $right:literal;)+) => {
        /// The explanation of a code and its examples.
        #[must_use]
        pub fn example(code: Code) -> Example {
            match code {$(
                Code::$code => Example { text: $text, wrong: $wrong, right: $right },
            )+}
        }
    };
}

examples! {
    FileMissing: "A document names a file that does not exist. Paths are relative to the file that writes them.",
        r#"include = ["materials.toml"]"# => "[material.clay]";
    FileUnreadable: "A document names something that cannot be read: a folder, or a file without permission.",
        r#"include = ["."]"# => "[material.clay]";
    OutsideRoot: "Paths are relative, use `/`, and stay inside the project: a document must mean the same on every machine. Links are followed before the check.",
        "[material.clay]\ncolor-texture = \"/home/me/clay.png\"" => "[material.clay]\ncolor-texture = \"textures/clay.png\"";
    NotText: "Documents are UTF-8 text, with or without a byte order mark. Editors call UTF-16 \"Unicode\" sometimes; save as UTF-8.",
        "" => "";
    Syntax: "The text is not TOML 1.0. Strings stand in quotes, inline tables on one line, and numbers have a decimal point.",
        "[shape.ball.sphere]\nradius = 1,5" => "[shape.ball.sphere]\nradius = 1.5";
    TooDeep: "Brackets, includes or definitions that use each other are nested too deeply. The depth of definitions is `recursion` in [limits].",
        "[limits]\nrecursion = 1\n[shape.a.sphere]\nradius = 1\n[shape.b.copy]\nof = \"a\"" =>
        "[limits]\nrecursion = 2\n[shape.a.sphere]\nradius = 1\n[shape.b.copy]\nof = \"a\"";
    TooLarge: "A file, or all files of a document together, are larger than 4 GiB.",
        "" => "";
    Unclosed: "A bracket or brace is opened and never closed. What follows it cannot be understood.",
        "[shape.a.box]\nsize = [1, 2, 3" => "[shape.a.box]\nsize = [1, 2, 3]";
    UnknownField: "A table has a key that means nothing there. Keys are in kebab-case, and unknown ones are errors, so that no slip of the pen passes unseen.",
        "[shape.a.sphere]\nradus = 1" => "[shape.a.sphere]\nradius = 1";
    MissingField: "A table lacks a key that has no default.",
        "[shape.a.cylinder]\nradius = 1" => "[shape.a.cylinder]\nradius = 1\nheight = 2";
    NoKind: "A curve or a shape has exactly one kind, which is the last word of its header: [curve.NAME.KIND], [shape.NAME.KIND].",
        "[shape.a]\nat = [0, 1, 0]" => "[shape.a]\nat = [0, 1, 0]\n[shape.a.sphere]\nradius = 1";
    ManyKinds: "A curve or a shape has exactly one kind. Give the second one a name of its own.",
        "[shape.a.sphere]\nradius = 1\n[shape.a.box]\nsize = [1, 1, 1]" =>
        "[shape.a.sphere]\nradius = 1\n[shape.b.box]\nsize = [1, 1, 1]";
    Conflict: "Two keys exclude each other, or one has no effect beside the other.",
        "[curve.a.arc]\nradius = 1\npoints = [[0, 0], [1, 1], [2, 0]]" =>
        "[curve.a.arc]\npoints = [[0, 0], [1, 1], [2, 0]]";
    WrongType: "A value is of another type than its key asks for, whether written or computed.",
        "[shape.a.sphere]\nradius = \"1\"" => "[shape.a.sphere]\nradius = 1";
    WrongLength: "An array has more or fewer items than its key asks for. Nothing is dropped or filled in silently.",
        "[shape.a.box]\nsize = [1, 2]" => "[shape.a.box]\nsize = [1, 2, 3]";
    OutOfRange: "A number is outside of the range that makes sense for its key.",
        "[shape.a.sphere]\nradius = -1" => "[shape.a.sphere]\nradius = 1";
    NotFinite: "TOML has `nan` and `inf`, geometry has not. Numbers beyond 1e15 are refused too: what is computed from them overflows.",
        "[shape.a.sphere]\nradius = inf" => "[shape.a.sphere]\nradius = 1000";
    UnknownChoice: "Only certain words can stand here; the message lists them.",
        "unit = \"meter\"" => "unit = \"m\"";
    Malformed: "A text is not of the form that its key asks for, such as a color or a size of memory.",
        "[material.a]\ncolor = \"red\"" => "[material.a]\ncolor = \"#ff0000\"";
    BadName: "Names are in kebab-case: lower-case letters and digits, words joined by `-`, a letter first.",
        "[material.OldClay]" => "[material.old-clay]";
    UnknownName: "A definition uses a name that no definition of that family has.",
        "[shape.a]\nmaterial = \"clay\"\nsphere = { radius = 1 }" =>
        "[shape.a]\nmaterial = \"clay\"\nsphere = { radius = 1 }\n[material.clay]";
    WrongFamily: "The name exists, but names something else. Curves, shapes, materials and nodes have a namespace each.",
        "[shape.ball.sphere]\nradius = 1\n[shape.vase.revolve]\nprofile = \"ball\"" =>
        "[curve.ball.circle]\nradius = 1\ncenter = [2, 0]\n[shape.vase.revolve]\nprofile = \"ball\"";
    Cycle: "Definitions are evaluated by demand, each once; one that needs itself, directly or through others, has no value.",
        "[shape.a.copy]\nof = \"b\"\n[shape.b.copy]\nof = \"a\"" =>
        "[shape.a.copy]\nof = \"b\"\n[shape.b.sphere]\nradius = 1";
    DuplicateName: "A name or a key is given twice, in one document or in two that are included together.",
        "[material.a]\nroughness = 1\nroughness = 0.5" => "[material.a]\nroughness = 0.5";
    UnusedParameter: "A parameter is in no expression, so changing it changes nothing: often its name is misspelt where it should be used. A warning.",
        "[parameters]\nheight = 1" => "[parameters]\nheight = 1\n[shape.a.sphere]\nradius = \"= height\"";
    NothingToBake: "A document without nodes shows the shapes that nothing else uses; this one has none.",
        "" => "[shape.a.sphere]\nradius = 1";
    ExpressionSyntax: "An expression cannot be read. `+` and `-` need a space on both sides, since `-` may be part of a name.",
        "[shape.a.sphere]\nradius = \"= 2-1\"" => "[shape.a.sphere]\nradius = \"= 2 - 1\"";
    UnknownVariable: "An expression uses a name that is not in [parameters]. `wall-thickness` is one name; a difference is `wall - thickness`.",
        "[shape.a.sphere]\nradius = \"= size\"" => "[parameters]\nsize = 1\n[shape.a.sphere]\nradius = \"= size\"";
    UnknownFunction: "An expression calls a function that does not exist; the reference page lists them.",
        "[shape.a.sphere]\nradius = \"= root(4)\"" => "[shape.a.sphere]\nradius = \"= sqrt(4)\"";
    ExpressionType: "An operation or a function is given a value that it does not work on.",
        "[shape.a.sphere]\nradius = \"= 'a' * 2\"" => "[shape.a.sphere]\nradius = \"= 1 * 2\"";
    ArgumentCount: "A function is given too few or too many arguments.",
        "[shape.a.sphere]\nradius = \"= mix(1, 2)\"" => "[shape.a.sphere]\nradius = \"= mix(1, 2, 0.5)\"";
    ExpressionValue: "An operation has no finite value: a division by zero, the root of a negative number.",
        "[shape.a.sphere]\nradius = \"= 1 / 0\"" => "[shape.a.sphere]\nradius = \"= 1 / 2\"";
    ExpressionLimit: "An expression is nested too deeply or too long, or the expressions of the document take too many steps or make too many items.",
        "[curve.a.polyline]\npoints = { count = 1e9, each = \"= [i, 0]\" }" =>
        "[curve.a.polyline]\npoints = { count = 100, each = \"= [i, 0]\" }";
    ParameterCycle: "A parameter is computed from itself, directly or through others.",
        "[parameters]\na = \"= b\"\nb = \"= a\"" => "[parameters]\na = \"= b\"\nb = 1\n[shape.s.sphere]\nradius = \"= a\"";
    BadOverride: "`--set name=value` names a parameter that the document does not have, or gives it a value of another type.",
        "" => "";
    ReservedName: "A parameter cannot have the name of a function, of a word of the expression language, or `i`.",
        "[parameters]\nmin = 1" => "[parameters]\nleast = 1\n[shape.a.sphere]\nradius = \"= least\"";
    IncludeCycle: "A document includes itself, directly or through others.",
        "include = [\"example.toml\"]" => "";
    IncludeConflict: "An included document is written in another unit or axis, or says what only the main document can say: `tolerance`, `asset`, `limits`.",
        "" => "";
    UnknownVariant: "The variant that was asked for is not in the document.",
        "" => "[variant.tall.parameters]\n[shape.a.sphere]\nradius = 1";
    LimitRaised: "[limits] in a document can only lower the limits: what a stranger's document may use is for the machine's owner to say.",
        "[limits]\ntriangles = 100_000_000" => "[limits]\ntriangles = 1_000_000";
    RepeatedPoints: "Two consecutive points are equal. A curve has no direction there, and a spline through them no parameter.",
        "[curve.a.polyline]\npoints = [[0, 0], [0, 0], [1, 0]]" => "[curve.a.polyline]\npoints = [[0, 0], [1, 0]]";
    Degenerate: "What is written determines no curve or surface, or copies that all stand in one place.",
        "[curve.a.arc]\npoints = [[0, 0], [1, 0], [2, 0]]" => "[curve.a.arc]\npoints = [[0, 0], [1, 1], [2, 0]]";
    WrongCount: "The number of items does not fit the other keys of the table.",
        "[curve.a.bezier]\npoints = [[0, 0], [1, 1], [2, 0]]" =>
        "[curve.a.bezier]\npoints = [[0, 0], [1, 1], [2, 0]]\ndegree = 2";
    NotIncreasing: "The parameters of a spline must increase from point to point.",
        "[curve.a.natural-spline]\npoints = [[0, 0], [1, 0], [2, 0]]\nparameters = [0, 2, 1]" =>
        "[curve.a.natural-spline]\npoints = [[0, 0], [1, 0], [2, 0]]\nparameters = [0, 1, 2]";
    KnotOrder: "Knots are the parameters at which the pieces of a B-spline meet. They may be equal, but never decrease.",
        "[curve.a.b-spline]\npoints = [[0, 0], [1, 1], [2, 0]]\ndegree = 2\nknots = [0, 0, 1, 0.5, 2, 2]" =>
        "[curve.a.b-spline]\npoints = [[0, 0], [1, 1], [2, 0]]\ndegree = 2\nknots = [0, 0, 0.5, 1, 2, 2]";
    KnotRepeated: "Each repetition of a knot takes one derivative from the smoothness there: as often as the degree it makes a corner, once more it would break the curve. At the ends it may stand once more than the degree.",
        "[curve.a.b-spline]\npoints = [[0, 0], [1, 1], [2, 0], [3, 1], [4, 0]]\ndegree = 1\nknots = [0, 0, 1, 1, 2, 3, 3]" =>
        "[curve.a.b-spline]\npoints = [[0, 0], [1, 1], [2, 0], [3, 1], [4, 0]]\ndegree = 1\nknots = [0, 0, 1, 2, 3, 4, 4]";
    BadWeight: "The weight of a control point says how strongly it draws the curve. It is at least 0; a point of weight 0 lies at infinity in the direction that is written, and enough finite points must stand around it.",
        "[curve.a.bezier]\npoints = [[1, 0], [0, 1], [-1, 0]]\ndegree = 2\nweights = [1, -1, 1]" =>
        "[curve.a.bezier]\npoints = [[1, 0], [0, 1], [-1, 0]]\ndegree = 2\nweights = [1, 0, 1]";
    FewPoints: "An open B-spline needs at least one control point more than its degree.",
        "[curve.a.b-spline]\npoints = [[0, 0], [1, 1], [2, 0]]" =>
        "[curve.a.b-spline]\npoints = [[0, 0], [1, 1], [2, 0]]\ndegree = 2";
    ZeroTangent: "A Hermite curve takes its direction at each point from the tangent there. Without a length there is no direction, and the curve would stop.",
        "[curve.a.hermite]\npoints = [[0, 0], [1, 1]]\ntangents = [[0, 0], [1, 0]]" =>
        "[curve.a.hermite]\npoints = [[0, 0], [1, 1]]\ntangents = [[0, 1], [1, 0]]";
    TensionRange: "The four-point scheme is proved to have a limit with a direction everywhere for tensions between 0 and 1/8. Beyond it corners and folds appear at every scale.",
        "[curve.a.subdivision]\nscheme = \"four-point\"\npoints = [[0, 0], [1, 1], [2, 0], [3, 1]]\ntension = 0.2" =>
        "[curve.a.subdivision]\nscheme = \"four-point\"\npoints = [[0, 0], [1, 1], [2, 0], [3, 1]]\ntension = 0.0625";
    PiecesApart: "Each piece of a curve begins where the one before ends. The labels show both places.",
        "[curve.a.cubic]\ncoefficients = [[[0, 0], [1, 0], [0, 0], [0, 1]], [[1, 0], [1, 3], [0, 0], [0, 0]]]" =>
        "[curve.a.cubic]\ncoefficients = [[[0, 0], [1, 0], [0, 0], [0, 1]], [[1, 1], [1, 3], [0, 0], [0, 0]]]";
    FormulaValue: "A formula must have a finite value over its whole range: no division by zero, no root or logarithm of what is negative. The message names the place and the part of the formula.",
        "[curve.a.formula]\ny = \"= sqrt(1 - x ^ 2)\"\nfrom = -2\nto = 1" =>
        "[curve.a.formula]\ny = \"= sqrt(1 - x ^ 2)\"\nfrom = -1\nto = 1\n[shape.s.sphere]\nradius = 1";
    FormulaJump: "A curve is one piece. Formulas with `floor`, `sign`, `%` or `if` may jump; end the curve there, or lead over with `smoothstep` or `mix`. Kinks are no jumps: they become corners.",
        "[curve.a.formula]\ny = \"= if(x < 0, 0, 1)\"\nfrom = -1\nto = 1" =>
        "[curve.a.formula]\ny = \"= smoothstep(-0.5, 0.5, x)\"\nfrom = -1\nto = 1\n[shape.s.sphere]\nradius = 1";
    FormulaWild: "A formula is studied before it is used, so that no kink and no place without a value is missed. One with hundreds of thousands of waves is refused.",
        "[curve.a.formula]\ny = \"= abs(sin(1e9 * x))\"\nfrom = 0\nto = 360" =>
        "[curve.a.formula]\ny = \"= abs(sin(10 * x))\"\nfrom = 0\nto = 360\n[shape.s.sphere]\nradius = 1";
    SvgSyntax: "The data of an SVG path is read to the end of its grammar, as a browser reads it, but a browser draws what stands before a fault and says nothing. The message names the character.",
        "[curve.a.svg]\nd = \"M 0 0 L 10\"" => "[curve.a.svg]\nd = \"M 0 0 L 10 5\"";
    ManyParts: "SVG paths, groups and operations on profiles are curves of several parts. Extrude, sheet, wire and the operations take all of them; where one curve is needed, such as a path or a section, take one with `part`.",
        "[curve.a.svg]\nd = \"M0 0H1 M0 1H1\"\n[shape.s.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = \"a\"" =>
        "[curve.a.svg]\nd = \"M0 0H1 M0 1H1\"\n[shape.s.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = { part = { of = \"a\", index = 0 } }";
    NoPart: "Parts are counted from 0. `kiln sample --curve NAME` shows all of them.",
        "[curve.a.part]\nof = { circle = { radius = 1 } }\nindex = 1" =>
        "[curve.a.part]\nof = { circle = { radius = 1 } }\nindex = 0\n[shape.s.sphere]\nradius = 1";
    NoZero: "An implicit curve is where its formula is 0, inside of its box. This one is everywhere more or everywhere less.",
        "[curve.a.implicit]\nf = \"= x^2 + y^2 - 9\"\nmin = [-1, -1]\nmax = [1, 1]" =>
        "[curve.a.implicit]\nf = \"= x^2 + y^2 - 9\"\nmin = [-4, -4]\nmax = [4, 4]\n[shape.s.sphere]\nradius = 1";
    SingularCurve: "Near the places named the zeros of a formula cross, end in a tip, form a lone point or a whole area, or touch the border of the box; or the formula has a kink or no value there. The box must leave such places out.",
        "[curve.a.implicit]\nf = \"= x * y\"\nmin = [-1, -1]\nmax = [1, 1]" =>
        "[curve.a.implicit]\nf = \"= x * y - 0.01\"\nmin = [-1, -1]\nmax = [1, 1]\n[shape.s.sphere]\nradius = 1";
    FaceIndex: "A face names a point that is not in the list. Indices count from 0.",
        "[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nfaces = [[1, 2, 3]]" =>
        "[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nfaces = [[0, 1, 2]]";
    FaceCorners: "A face needs at least three corners, all different.",
        "[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nfaces = [[0, 1, 1]]" =>
        "[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nfaces = [[0, 1, 2]]";
    AcrossAxis: "A profile that is turned about the y axis stays on one side of it: x is the radius. A profile that ends on the axis ends at x = 0.",
        "[shape.a.revolve]\nprofile = { polyline = { points = [[-0.1, 0], [1, 0], [1, 1]] } }" =>
        "[shape.a.revolve]\nprofile = { polyline = { points = [[0, 0], [1, 0], [1, 1]] } }";
    OpenProfile: "A solid with flat ends needs an outline that comes back to its start.",
        "[shape.a.extrude]\nprofile = { polyline = { points = [[0, 0], [1, 0], [1, 1]] } }\nheight = 1" =>
        "[shape.a.extrude]\nprofile = { polyline = { points = [[0, 0], [1, 0], [1, 1]], closed = true } }\nheight = 1";
    SelfCrossing: "An outline that crosses or touches itself has no inside. The message names the place and the parameters of the curve.",
        "[shape.a.extrude]\nprofile = { polyline = { points = [[0, 0], [1, 1], [1, 0], [0, 1]], closed = true } }\nheight = 1" =>
        "[shape.a.extrude]\nprofile = { polyline = { points = [[0, 0], [1, 0], [1, 1], [0, 1]], closed = true } }\nheight = 1";
    NoArea: "A profile on the axis, or an outline whose points lie on one line, sweeps no surface.",
        "[shape.a.revolve]\nprofile = { line = { from = [0, 0], to = [0, 1] } }" =>
        "[shape.a.revolve]\nprofile = { line = { from = [1, 0], to = [1, 1] } }";
    BrokenJoint: "What is declared of a joint of a path is proved: at a \"smooth\" one both segments must have one direction, at \"C1\" one first derivative, at \"G2\" one curvature, at \"C2\" one second derivative.",
        "[curve.a.path]\nstart = [0, 0]\nsegments = [{ line = [[1, 0]] }, { line = [[1, 1]] }]\njoints = [\"smooth\"]" =>
        "[curve.a.path]\nstart = [0, 0]\nsegments = [{ line = [[1, 0]] }, { arc = { center = [1, 1], angle = 90 } }]\njoints = [\"smooth\"]\n[shape.b.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = \"a\"";
    Reversal: "Where a path turns back on itself a section has no plane to stand in. Round such a corner with an arc or a spline.",
        "[shape.a.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = { polyline = { points = [[0, 0], [1, 0], [0, 0.01]] } }" =>
        "[shape.a.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = { polyline = { points = [[0, 0], [1, 0], [1, 1]] } }";
    NotFlat: "Profiles and outlines lie in the x, y plane: two numbers a point. Only paths go through space.",
        "[shape.a.revolve]\nprofile = { line = { from = [1, 0, 0], to = [1, 1, 1] } }" =>
        "[shape.a.revolve]\nprofile = { line = { from = [1, 0], to = [1, 1] } }";
    BadHole: "Holes lie inside their outline and apart from each other.",
        "[shape.a.extrude]\nprofile = { circle = { radius = 1 } }\nholes = [{ circle = { radius = 0.5, center = [1, 0] } }]\nheight = 1" =>
        "[shape.a.extrude]\nprofile = { circle = { radius = 1 } }\nholes = [{ circle = { radius = 0.5 } }]\nheight = 1";
    TightBend: "A section that reaches beyond the center of a bend of its path makes a surface that folds over itself. Beside sharp corners the mesh may also stay further from such a surface than its tolerance; the report carries the distance that was reached. Widen the bend, round the corner, or make the section smaller.",
        "[shape.a]\nsegments = 32\n[shape.a.sweep]\nprofile = { circle = { radius = 1 } }\npath = { circle = { radius = 0.5 } }" =>
        "[shape.a.sweep]\nprofile = { circle = { radius = 0.4 } }\npath = { circle = { radius = 0.5 } }";
    BadMesh: "Polygons refer to points that are not there or have coordinates that are no numbers.",
        "" => "";
    BeyondPrecision: "A glTF file holds positions in single precision: about seven digits. Far from the origin, or where the tolerance is very fine, rounding alone moves points by more than half the tolerance. Model near the origin and let a node carry the shape to its place, or write a coarser tolerance.",
        "tolerance = 0.001\n[shape.a.sphere]\nradius = 1\ncenter = [30000, 0, 0]" =>
        "tolerance = 0.001\n[shape.a.sphere]\nradius = 1\n[node.n]\nshape = \"a\"\nat = [30000, 0, 0]";
    LongerThanPath: "A shape that is laid along an open path keeps its length, so it must not reach beyond either end of the path. Stretch it to the path with `stretch = true`, choose another `from`, or write a longer path; a closed path is gone around again.",
        "[shape.a.along]\nof = { box = { size = [0.1, 0.1, 4] } }\npath = { arc = { radius = 2, from = 0, to = 90 } }" =>
        "[shape.a.along]\nof = { box = { size = [0.1, 0.1, 4] } }\npath = { arc = { radius = 2, from = 0, to = 90 } }\nstretch = true";
    OpenAndClosed: "A surface between curves joins point to point. Where one of them comes back to its start and the other does not, the surface would have a slit that nobody asked for.",
        "[shape.a.ruled]\nfrom = { circle = { radius = 1 } }\nto = { polyline = { points = [[0, 0, 1], [1, 0, 1], [1, 1, 1]] } }" =>
        "[shape.a.ruled]\nfrom = { circle = { radius = 1 } }\nto = { polyline = { points = [[0, 0, 1], [1, 0, 1], [1, 1, 1]], closed = true } }";
    Coincident: "A surface lies between two curves, or between a curve and a point. Where they are the same line in space there is nothing between them.",
        "[curve.c.circle]\nradius = 1\n[shape.a.ruled]\nfrom = \"c\"\nto = \"c\"" =>
        "[curve.c.circle]\nradius = 1\n[shape.a.ruled]\nfrom = \"c\"\nto = { transform = { of = \"c\", at = [0, 0, 1] } }";
    NoFlatEnd: "Solids between closed curves end in flat faces, so these curves must be flat and enclose an area. Leave the faces out with `caps = false`, or close the end with a shape of its own.",
        "[shape.a.ruled]\nfrom = { polyline = { points = [[0, 0], [1, 0, 1], [1, 1], [0, 1, 1]], closed = true } }\nto = [0, 0, 4]" =>
        "[shape.a.ruled]\nfrom = { polyline = { points = [[0, 0], [1, 0, 1], [1, 1], [0, 1, 1]], closed = true } }\nto = [0, 0, 4]\ncaps = false";
    FoldsOver: "A bend presses together what lies inside of it. What reaches beyond the center of the bend would be turned inside out. Bend less, over a greater length, or a thinner shape; or move the axis with `around`.",
        "[shape.a.bend]\nof = { box = { size = [2, 1, 1] } }\nangle = 90" =>
        "[shape.a.bend]\nof = { box = { size = [1, 2, 1] } }\nangle = 90";
    NoLength: "A taper, twist or bend goes from one place on its axis to another. The shape must have a length along the axis, `to` must lie after `from`, and an axis cannot bend toward itself.",
        "[shape.a.twist]\nof = { box = { size = [1, 1, 1] } }\nangle = 90\nfrom = 0.2\nto = 0.1" =>
        "[shape.a.twist]\nof = { box = { size = [1, 1, 1] } }\nangle = 90\nfrom = 0.1\nto = 0.2";
    CorneredPath: "A shape laid along a path with a corner would tear there. Round the corner with an arc or a spline.",
        "[shape.a.along]\nof = { box = { size = [0.1, 0.1, 1] } }\npath = { polyline = { points = [[0, 0], [1, 0], [1, 1]] } }" =>
        "[shape.a.along]\nof = { box = { size = [0.1, 0.1, 1] } }\npath = { arc = { radius = 1, from = 0, to = 90 } }";
    NoPlane: "A loft leaves a profile at right angles to its plane, and a round tip spreads in the plane of its neighbor. A straight line, or a curve that leaves its plane, has none.",
        "[shape.a.loft]\nprofiles = [{ line = { from = [0, 0], to = [1, 0] } }, { line = { from = [0, 0, 1], to = [1, 0, 1] } }]\nstart = \"straight\"" =>
        "[shape.a.loft]\nprofiles = [{ line = { from = [0, 0], to = [1, 0] } }, { line = { from = [0, 0, 1], to = [1, 0, 1] } }]\nstart = { first = [0, 0, 1] }";
    UnmetSeam: "Around a closed path the section comes back to where it began. There it must be what it was: of the same size, the same profile, and turned so that it lies on itself - by whole turns, or by a part of a turn that the profile's own symmetry allows.",
        "[shape.a.sweep]\nprofile = { ellipse = { radii = [0.2, 0.1] } }\npath = { circle = { radius = 1 } }\ntwist = 90" =>
        "[shape.a.sweep]\nprofile = { ellipse = { radii = [0.2, 0.1] } }\npath = { circle = { radius = 1 } }\ntwist = 180";
    BadFactors: "A curve of factors says how large a section is at each share of its way: x is the share and must increase from 0 to 1, y is the factor and must not be negative.",
        "[shape.a.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = { line = { from = [0, 0, 0], to = [0, 1, 0] } }\nscale = { line = { from = [0, 1], to = [2, 0] } }" =>
        "[shape.a.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = { line = { from = [0, 0, 0], to = [0, 1, 0] } }\nscale = { line = { from = [0, 1], to = [1, 0] } }";
    MixedProfiles: "A section that changes along its way is closed everywhere or open everywhere: between a ring and a strip there is no section that is either.",
        "[shape.a.sweep]\nprofiles = [{ circle = { radius = 0.1 } }, { line = { from = [-0.1, 0], to = [0.1, 0] } }]\npath = { line = { from = [0, 0, 0], to = [0, 1, 0] } }" =>
        "[shape.a.sweep]\nprofiles = [{ circle = { radius = 0.1 } }, { ellipse = { radii = [0.1, 0.01] } }]\npath = { line = { from = [0, 0, 0], to = [0, 1, 0] } }";
    AlongAxis: "A profile that rises while it turns about the axis sweeps a surface wherever it is off the axis. What runs along the axis itself only glides along itself.",
        "[shape.a.revolve]\nprofile = { polyline = { points = [[0, 0], [1, 0], [1, 1], [0, 1]], closed = true } }\nangle = 720\nrise = 4" =>
        "[shape.a.revolve]\nprofile = { polyline = { points = [[0.1, 0], [1, 0], [1, 1], [0.1, 1]], closed = true } }\nangle = 720\nrise = 4";
    TurnsMeet: "After a full turn a screw stands above where it began, by what one turn rises. A profile that is higher than that cuts into the turn before.",
        "[shape.a.revolve]\nprofile = { circle = { radius = 0.2, center = [1, 0] } }\nangle = 1080\nrise = 1" =>
        "[shape.a.revolve]\nprofile = { circle = { radius = 0.2, center = [1, 0] } }\nangle = 1080\nrise = 1.5";
    SelfOverlap: "Two parts of a sweep that are far apart along its path stand in the same place: a coil with too little pitch, a path that crosses itself. The surface cuts itself there, and the volume of what is in both counts twice.",
        "[shape.a.sweep]\nprofile = { circle = { radius = 0.3 } }\npath = { helix = { radius = 2, pitch = 0.5, turns = 2 } }" =>
        "[shape.a.sweep]\nprofile = { circle = { radius = 0.3 } }\npath = { helix = { radius = 2, pitch = 0.65, turns = 2 } }";
    DoesNotFit: "Each measure of a shape is right by itself, but they do not go together: a rounding wider than its box, a hole wider than its tube.",
        "[shape.a.box]\nsize = [4, 1, 4]\nradius = 0.6" => "[shape.a.box]\nsize = [4, 1, 4]\nradius = 0.4";
    AlongUp: "With `frame = \"up\"` the profile stands upright across its path. Where the path itself runs along `up`, no way of standing is more upright than another, and just beside that place the profile would spin.",
        "[curve.way.polyline]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\n[shape.a.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = \"way\"\nframe = \"up\"" =>
        "[curve.way.polyline]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0]]\n[shape.a.sweep]\nprofile = { circle = { radius = 0.1 } }\npath = \"way\"\nframe = \"up\"\nup = [0, 0, 1]";
    FoldedFace: "The outline of a face crosses itself, most often because two corners are named in the wrong order. It is cut into triangles all the same, some of which lie over others.",
        "[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 2, 0]]\nfaces = [[0, 2, 1, 3]]" =>
        "[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 2, 0]]\nfaces = [[0, 1, 2, 3]]";
    FlatFace: "A face encloses nothing: its corners lie on one line or at one place, or its outline runs back the way it came. Such faces are kept where others share their edges; they have no area to see.",
        "[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 2, 0]]\nfaces = [[0, 1, 2], [0, 2, 3]]" =>
        "[shape.a.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 2, 0]]\nfaces = [[0, 1, 2, 3]]";
    StrayHole: "Of the loops of a polygon those that turn counterclockwise are outlines, and those that turn clockwise are holes, each in the outline around it.",
        "[shape.a.polygon]\nloops = [[[0, 0], [0, 1], [1, 0]]]" => "[shape.a.polygon]\nloops = [[[0, 0], [1, 0], [0, 1]]]";
    TexturedWire: "A wire is made of lines, which have no surface for a texture. Give it a material with a plain color, or draw a thin profile along its curves with `sweep`.",
        "[material.m]\ncolor-texture = \"label.png\"\n[shape.a]\nmaterial = \"m\"\n[shape.a.wire]\ncurves = [{ circle = { radius = 1 } }]" =>
        "[material.m]\ncolor = \"#b5651d\"\n[shape.a]\nmaterial = \"m\"\n[shape.a.wire]\ncurves = [{ circle = { radius = 1 } }]";
    PartsMeet: "Parts of a profile lie apart from each other or inside of each other. Where they cross it is not said what they enclose: join them with `union` first.",
        "[shape.a.extrude]\nprofile = { group = { of = [{ circle = { radius = 1 } }, { circle = { radius = 1, center = [1, 0] } }] } }\nheight = 1" =>
        "[shape.a.extrude]\nprofile = { group = { of = [{ circle = { radius = 1 } }, { circle = { radius = 1, center = [3, 0] } }] } }\nheight = 1";
    NothingLeft: "An operation on profiles may leave nothing: an offset inward by more than half of the width, a difference that takes all away, an intersection of curves that lie apart.",
        "[shape.a.extrude]\nprofile = { offset = { of = { circle = { radius = 1 } }, distance = -1.5 } }\nheight = 1" =>
        "[shape.a.extrude]\nprofile = { offset = { of = { circle = { radius = 1 } }, distance = -0.5 } }\nheight = 1";
    UnclearContact: "Where two outlines touch without crossing, the least rounding decides whether what they enclose hangs together there. Move one of them, so that they cross clearly or stand apart.",
        "" => "";
    NoRoom: "A rounded corner takes from both of its sides a length that grows with the radius, and with how sharp the corner is. The sides must be that long, and long enough for their other corners too.",
        "[shape.a.extrude]\nprofile = { fillet = { of = { polyline = { points = [[0, 0], [4, 0], [4, 2], [0, 2]], closed = true } }, radius = 1.5 } }\nheight = 1" =>
        "[shape.a.extrude]\nprofile = { fillet = { of = { polyline = { points = [[0, 0], [4, 0], [4, 2], [0, 2]], closed = true } }, radius = 0.5 } }\nheight = 1";
    NoCorner: "Corners are the places where the direction of a curve jumps. They are counted from 0 along the curve; one that is closed and starts in a corner has its first one there.",
        "[shape.a.extrude]\nprofile = { fillet = { of = { polyline = { points = [[0, 0], [4, 0], [4, 2]], closed = true } }, radius = 0.2, corners = [3] } }\nheight = 1" =>
        "[shape.a.extrude]\nprofile = { fillet = { of = { polyline = { points = [[0, 0], [4, 0], [4, 2]], closed = true } }, radius = 0.2, corners = [2] } }\nheight = 1";
    TooNarrow: "A bevel or a draft moves the outline inward on the way up, and nothing of it may close up or run into another part before it is there. The message tells how far it may reach.",
        "[shape.a.extrude]\nprofile = { polyline = { points = [[0, 0], [4, 0], [4, 2], [0, 2]], closed = true } }\nheight = 4\nbevel = 1.5" =>
        "[shape.a.extrude]\nprofile = { polyline = { points = [[0, 0], [4, 0], [4, 2], [0, 2]], closed = true } }\nheight = 4\nbevel = 0.5";
    ImportFailed: "A file is damaged or cut off. The message names its line and value. Export it again.",
        "" => "";
    ImportNote: "Something in an imported file was passed over or put right; the notes say what and where.",
        "" => "";
    UnsupportedFormat: "Only Wavefront OBJ (text) and STL are imported. The message says what the file is and what to export instead.",
        "" => "";
    BadImage: "Textures are PNG or JPEG, whole, and not larger than `image-pixels` in [limits]. Sizes are checked before anything is decoded.",
        "" => "";
    UnknownPart: "An imported file has no group or material of the name that is asked for; the notes list those it has.",
        "" => "";
    UnevenRows: "A grid of control points is written row by row, and every row has equally many.",
        "[shape.a.b-spline]\ndegree = 1\ncontrol = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 1], [2, 1, 0]]]" =>
        "[shape.a.b-spline]\ndegree = 1\ncontrol = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 1]]]";
    PatchIndex: "A patch chooses its control points by their numbers in `points`. They count from 0, or from 1 where `first = 1` is written.",
        "[shape.a.patches]\ndegree = 1\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1]]\npatches = [[1, 2, 3, 4]]" =>
        "[shape.a.patches]\ndegree = 1\nfirst = 1\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1]]\npatches = [[1, 2, 3, 4]]";
    PatchPoints: "A patch of degree p by q has (p + 1) times (q + 1) control points: a bicubic one 16, row by row.",
        "[shape.a.patches]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1]]\npatches = [[0, 1, 2, 3]]" =>
        "[shape.a.patches]\ndegree = 1\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1]]\npatches = [[0, 1, 2, 3]]";
    PatchGrid: "A grid holds whole patches: Bezier patches of degree 3 share their borders, so a row has 4, 7, 10, ... points, or 3, 6, 9, ... when closed. B-spline and Catmull-Rom patches lie between the inner points of four, and a row has 4, 5, 6, ... points.",
        "[shape.a.patches]\ndegree = 2\ncontrol = [[[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]], [[0, 1, 0], [1, 1, 1], [2, 1, 1], [3, 1, 0]], [[0, 2, 0], [1, 2, 0], [2, 2, 0], [3, 2, 0]]]" =>
        "[shape.a.patches]\ndegree = 2\ncontrol = [[[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 0], [1, 1, 1], [2, 1, 0]], [[0, 2, 0], [1, 2, 0], [2, 2, 0]]]";
    PatchGap: "Patches in one grid must meet: where one ends the next begins. A basis given as a matrix does so at a certain `step` only: Bernstein polynomials at 3, B-splines at 1.",
        "[shape.a.patches]\nbasis = [[-1, 3, -3, 1], [3, -6, 3, 0], [-3, 3, 0, 0], [1, 0, 0, 0]]\nstep = 1\ncontrol = [[[0, 1, 0], [1, 0, 0], [2, 0, 0], [3, 1, 0], [4, 0, 0]], [[0, 0, 1], [1, 0, 1], [2, 1, 1], [3, 0, 1], [4, 0, 1]], [[0, 0, 2], [1, 1, 2], [2, 0, 2], [3, 0, 2], [4, 1, 2]], [[0, 1, 3], [1, 0, 3], [2, 0, 3], [3, 1, 3], [4, 0, 3]]]" =>
        "[shape.a.patches]\nbasis = [[-1, 3, -3, 1], [3, -6, 3, 0], [-3, 3, 0, 0], [1, 0, 0, 0]]\nstep = 3\ncontrol = [[[0, 1, 0], [1, 0, 0], [2, 0, 0], [3, 1, 0], [4, 0, 0], [5, 0, 0], [6, 1, 0]], [[0, 0, 1], [1, 0, 1], [2, 1, 1], [3, 0, 1], [4, 0, 1], [5, 1, 1], [6, 0, 1]], [[0, 0, 2], [1, 1, 2], [2, 0, 2], [3, 0, 2], [4, 1, 2], [5, 0, 2], [6, 0, 2]], [[0, 1, 3], [1, 0, 3], [2, 0, 3], [3, 1, 3], [4, 0, 3], [5, 0, 3], [6, 1, 3]]]";
    BrokenSeam: "`continuity` states how smoothly patches must join. Tangent planes agree (G1) where the control points next to a side lie in one plane with it on both sides. `kiln sample --shape NAME FILE` lists all joints with their class and angle.",
        "[shape.a.patches]\ndegree = [2, 1]\ncontinuity = \"G1\"\ncontrol = [[[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 1, 0], [4, 1, 0]], [[0, 0, 1], [1, 0, 1], [2, 0, 1], [3, 1, 1], [4, 1, 1]]]" =>
        "[shape.a.patches]\ndegree = [2, 1]\ncontinuity = \"G1\"\ncontrol = [[[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0], [4, 1, 0]], [[0, 0, 1], [1, 0, 1], [2, 0, 1], [3, 0, 1], [4, 1, 1]]]";
    OpenSides: "The sides of a patch stand in order around it and meet: each begins or ends where the next one does. The message prints how far the nearest ends are apart.",
        "[shape.a.coons]\nsides = [{ line = { from = [0, 0], to = [1, 0] } }, { line = { from = [1, 0], to = [1, 1] } }, { line = { from = [1, 1], to = [0, 1] } }, { line = { from = [0, 1], to = [0, 0.1] } }]" =>
        "[shape.a.coons]\nsides = [{ line = { from = [0, 0], to = [1, 0] } }, { line = { from = [1, 0], to = [1, 1] } }, { line = { from = [1, 1], to = [0, 1] } }, { line = { from = [0, 1], to = [0, 0] } }]";
    CornerConflict: "At a corner of a bicubic patch the derivative across one side is the tangent of the side beside it, and where two sides say how the patch leaves them no `twist` can say otherwise.",
        "[shape.a.coons]\nblend = \"bicubic\"\nsides = [{ curve = { line = { from = [0, 0], to = [1, 0] } }, cross = [0, 1, 1] }, { line = { from = [1, 0], to = [1, 1] } }, { line = { from = [1, 1], to = [0, 1] } }, { line = { from = [0, 1], to = [0, 0] } }]" =>
        "[shape.a.coons]\nblend = \"bicubic\"\nsides = [{ curve = { line = { from = [0, 0], to = [1, 0] } }, cross = [0, 1, 0] }, { line = { from = [1, 0], to = [1, 1] } }, { line = { from = [1, 1], to = [0, 1] } }, { line = { from = [0, 1], to = [0, 0] } }]";
    BadNetwork: "In a network each curve along u meets each curve along v, all in the order in which they are listed.",
        "[shape.a.gordon]\nu = [{ line = { from = [0, 0, 0], to = [1, 0, 0] } }, { line = { from = [0, 1, 0], to = [1, 1, 0] } }]\nv = [{ line = { from = [0, 0, 0], to = [0, 1, 0] } }, { line = { from = [1, 0, 0.2], to = [1, 1, 0.2] } }]" =>
        "[shape.a.gordon]\nu = [{ line = { from = [0, 0, 0], to = [1, 0, 0] } }, { line = { from = [0, 1, 0], to = [1, 1, 0] } }]\nv = [{ line = { from = [0, 0, 0], to = [0, 1, 0] } }, { line = { from = [1, 0, 0], to = [1, 1, 0] } }]";
    NoQuadric: "An equation of the second degree need not have a surface: x² + y² + z² = -1 holds nowhere, x² + y² = 0 on a line. Or the surface lies elsewhere than `within`; the message names the kind and the place.",
        "[shape.a.quadric]\nxx = 1\nyy = 1\nzz = 1\nconstant = 1" =>
        "[shape.a.quadric]\nxx = 1\nyy = 1\nzz = 1\nconstant = -1";
    EndlessQuadric: "All quadrics but ellipsoids go on without end. `within` says where the shape ends: at the sides of a box.",
        "[shape.a.quadric]\nxx = 1\nyy = 1\nzz = -1\nconstant = -1" =>
        "[shape.a.quadric]\nxx = 1\nyy = 1\nzz = -1\nconstant = -1\nwithin = { min = [-2, -2, -1], max = [2, 2, 1] }";
    TrimSurface: "`trimmed` cuts one smooth surface over parameters u and v. Boxes, balls and turned shapes are none, and neither are shapes of several patches or surfaces with an edge inside.",
        "[shape.a.sphere]\nradius = 1\n[shape.b.trimmed]\nof = \"a\"\nprofile = { circle = { radius = 0.4 } }" =>
        "[shape.a.patches]\ndegree = 1\ncontrol = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 1]]]\n[shape.b.trimmed]\nof = \"a\"\nprofile = { circle = { radius = 0.4, center = [0.5, 0.5] } }";
    TrimOutside: "The outline of a trimmed surface is drawn on its parameters: x counts along u, y along v. It may touch their borders, which the message prints, but not leave them.",
        "[shape.a.patches]\ndegree = 1\ncontrol = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 1]]]\n[shape.b.trimmed]\nof = \"a\"\nprofile = { circle = { radius = 0.4 } }" =>
        "[shape.a.patches]\ndegree = 1\ncontrol = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 1]]]\n[shape.b.trimmed]\nof = \"a\"\nprofile = { circle = { radius = 0.4, center = [0.5, 0.5] } }";
    NoSurface: "Surfaces over two parameters have sides by which they can be joined. Shapes of other kinds stand together in a `group`.",
        "[shape.a.sphere]\nradius = 1\n[shape.b.patches]\ndegree = 1\ncontrol = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 1]]]\n[shape.c.joined]\nof = [\"a\", \"b\"]" =>
        "[shape.a.sphere]\nradius = 1\n[shape.b.patches]\ndegree = 1\ncontrol = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 1]]]\n[shape.c.group]\nof = [\"a\", \"b\"]";
    ApartSurfaces: "Joined surfaces share sides: whole lines, the same points at the same shares of the way. The message prints how far the nearest sides are apart.",
        "[shape.a.patches]\ndegree = 1\ncontrol = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]]]\n[shape.b.patches]\ndegree = 1\ncontrol = [[[1.1, 0, 0], [2, 0, 1]], [[1.1, 1, 0], [2, 1, 1]]]\n[shape.c.joined]\nof = [\"a\", \"b\"]" =>
        "[shape.a.patches]\ndegree = 1\ncontrol = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]]]\n[shape.b.patches]\ndegree = 1\ncontrol = [[[1, 0, 0], [2, 0, 1]], [[1, 1, 0], [2, 1, 1]]]\n[shape.c.joined]\nof = [\"a\", \"b\"]";
    TangledLines: "The lines that bound a curved face are cut into chords. Where two of them nearly touch, as where a surface runs along a side of its box, chords of one cross those of the other however short they are.",
        "[shape.a.quadric]\nyy = 1\nyz = 1\nx = 1e-4\nwithin = { min = [-2, 0, 0], max = [2, 0.001, 4] }" =>
        "[shape.a.quadric]\nyy = 1\nyz = 1\nx = 1e-4\nwithin = { min = [-2, -1, 0], max = [2, 1, 4] }";
    FormulaGap: "`closed` says that a surface by formulas comes back to its start, straight or with a twist. It is held against the formulas: sines and cosines come back after 360 degrees, of half an angle after 720. The message says how far the ends are apart, and where most.",
        "[shape.a.parametric]\nx = \"= cos(u)\"\ny = \"= v\"\nz = \"= sin(u)\"\nu = [0, 300]\nv = [0, 1]\nclosed = [\"u\"]" =>
        "[shape.a.parametric]\nx = \"= cos(u)\"\ny = \"= v\"\nz = \"= sin(u)\"\nu = [0, 360]\nv = [0, 1]\nclosed = [\"u\"]";
    OneSided: "A surface that closes with a twist, as a Moebius band or a Klein bottle, has no front: whoever walks around it comes back on its other side. Game engines show triangles from the front alone, so half of it would be missing. With a `thickness` it is a closed skin; or its material says `double-sided = true`.",
        "[shape.a.parametric]\nx = \"= (2 + v * cos(u / 2)) * cos(u)\"\ny = \"= v * sin(u / 2)\"\nz = \"= (2 + v * cos(u / 2)) * sin(u)\"\nu = [0, 360]\nv = [-0.5, 0.5]" =>
        "[shape.a.parametric]\nx = \"= (2 + v * cos(u / 2)) * cos(u)\"\ny = \"= v * sin(u / 2)\"\nz = \"= (2 + v * cos(u / 2)) * sin(u)\"\nu = [0, 360]\nv = [-0.5, 0.5]\nthickness = 0.05";
    TooThick: "Half of a surface's thickness lies on each side of it. Where the surface bends with a smaller radius than that, the inner side would fold over itself.",
        "[shape.a.parametric]\nx = \"= u\"\ny = \"= u ^ 2\"\nz = \"= v\"\nu = [-1, 1]\nv = [0, 1]\nthickness = 1.2" =>
        "[shape.a.parametric]\nx = \"= u\"\ny = \"= u ^ 2\"\nz = \"= v\"\nu = [-1, 1]\nv = [0, 1]\nthickness = 0.2";
    SolidSyntax: "An expression of solids has names of shapes with `+`, `-` or `&` between them, and parentheses. Names may have hyphens in them, so a minus sign stands between spaces.",
        "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b.sphere]\nradius = 1.2\n[shape.c.solid]\nof = \"a - \"" =>
        "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b.sphere]\nradius = 1.2\n[shape.c.solid]\nof = \"a - b\"";
    NotClosed: "Solid operations need shapes that enclose something: each edge has a face on both sides, and neighbors look the same way. The message shows where it is not so.",
        "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b.plane]\nsize = [1, 1]\n[shape.c.difference]\nof = [\"a\", \"b\"]" =>
        "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b.box]\nsize = [1, 3, 1]\n[shape.c.difference]\nof = [\"a\", \"b\"]";
    InsideOut: "The faces of a shape look inward, so that it would be everything but what it is meant to be; or it encloses no volume at all. List the corners of its faces the other way round.",
        "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]\nfaces = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]]\n[shape.c.union]\nof = [\"a\", \"b\"]" =>
        "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]\nfaces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]\n[shape.c.union]\nof = [\"a\", \"b\"]";
    CrossesItself: "What lies inside of a skin that crosses itself cannot be told. Put it together from parts that do not, as a union.",
        "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [0.2, 0.2, -1]]\nfaces = [[0, 2, 1], [0, 1, 4], [0, 4, 2], [1, 3, 4], [4, 3, 2], [1, 2, 3]]\n[shape.c.union]\nof = [\"a\", \"b\"]" =>
        "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.mesh]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]\nfaces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]\n[shape.c.union]\nof = [\"a\", \"b\"]";
    NoSolid: "Shapes that only touch have nothing in common, and of a shape without itself nothing is left. A wall thicker than half of the shape leaves no hollow.",
        "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.copy]\nof = \"a\"\n[shape.c.difference]\nof = [\"a\", \"b\"]" =>
        "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b]\nat = [0.5, 0, 0]\n[shape.b.copy]\nof = \"a\"\n[shape.c.difference]\nof = [\"a\", \"b\"]";
    NoFaceThere: "A hollow opens through flat faces: `open` names the plane that one lies in, and its normal looks out of the shape.",
        "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b.shell]\nof = \"a\"\nthickness = 0.2\nopen = [{ normal = [0, 1, 0], point = [0, 0.9, 0] }]" =>
        "[shape.a.box]\nsize = [2, 2, 2]\n[shape.b.shell]\nof = \"a\"\nthickness = 0.2\nopen = [{ normal = [0, 1, 0], point = [0, 1, 0] }]";
    BadCage: "A cage is a surface: at most two faces share an edge, neighbors turn the same way, faces around a vertex form one fan, and each vertex belongs to a face. The message names the vertices, which count from 0.",
        "[shape.a.subdivide]\ncage = { mesh = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces = [[0, 1, 2], [0, 1, 3]] } }" =>
        "[shape.a.subdivide]\ncage = { mesh = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], faces = [[0, 1, 2], [1, 0, 3]] } }";
    NoCageEdge: "A crease names an edge by its two vertices, which are neighbors along a side of a face. Vertices count from 0 in the order of the cage.",
        "[shape.a.subdivide]\ncage = { box = { size = [1, 1, 1] } }\ncreases = [{ edges = [[0, 7]] }]" =>
        "[shape.a.subdivide]\ncage = { box = { size = [1, 1, 1] } }\ncreases = [{ edges = [[0, 1]] }]";
    NeedsTriangles: "The schemes \"loop\", \"sqrt3\" and \"butterfly\" split triangles. With `triangulate = true` other faces are cut into triangles first, with a warning.",
        "[shape.a.subdivide]\ncage = { box = { size = [1, 1, 1] } }\nscheme = \"loop\"" =>
        "[shape.a.subdivide]\ncage = { box = { size = [1, 1, 1] } }\nscheme = \"catmull-clark\"";
    OddLevels: "The sqrt(3) scheme cuts the edges of a border in three in every second level; after an odd number the border stands between two steps.",
        "[shape.a.subdivide]\ncage = { mesh = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces = [[0, 1, 2]] } }\nscheme = \"sqrt3\"\nlevels = 3" =>
        "[shape.a.subdivide]\ncage = { mesh = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces = [[0, 1, 2]] } }\nscheme = \"sqrt3\"\nlevels = 4";
    NoFieldSurface: "A field has a surface where its value is the level: here it stays on one side of it everywhere in the box. The box may lie beside the body, the level may be too high, or the potentials too weak to reach it.",
        "[shape.a.implicit]\nfield = { formula = { f = \"= x^2 + y^2 + z^2 + 1\" } }\nwithin = { min = [-2, -2, -2], max = [2, 2, 2] }" =>
        "[shape.a.implicit]\nfield = { formula = { f = \"= x^2 + y^2 + z^2 - 1\" } }\nwithin = { min = [-2, -2, -2], max = [2, 2, 2] }";
    LeavesBox: "The surface reaches the sides of its box, where it would be open. A larger box may hold it; what has no end is cut off by an intersection with a body, such as a box or a ball.",
        "[shape.a.implicit]\nfield = { formula = { f = \"= x^2 + y^2 + z^2 - 1\" } }\nwithin = { min = [-1, -1, -1], max = [1, 1, 0.5] }" =>
        "[shape.a.implicit]\nfield = { formula = { f = \"= x^2 + y^2 + z^2 - 1\" } }\nwithin = { min = [-1, -1, -1], max = [1, 1, 1.2] }";
    NeedsBox: "Of bodies, skeletons and what is joined of them a box is known that holds the surface. Of formulas, sums and half spaces none is: `within` says where to look.",
        "[shape.a.implicit]\nfield = { formula = { f = \"= x^2 + y^2 + z^2 - 1\" } }" =>
        "[shape.a.implicit]\nfield = { formula = { f = \"= x^2 + y^2 + z^2 - 1\" } }\nwithin = { min = [-2, -2, -2], max = [2, 2, 2] }";
    NoElement: "An element of a skeleton is one thing: a `point`, a `segment` of two points, a flat `polygon`, or a `curve`.",
        "[field.a.skeleton]\nelements = [{ radius = 1 }]\n[shape.a.implicit]\nfield = \"a\"" =>
        "[field.a.skeleton]\nelements = [{ point = [0, 0, 0], radius = 1 }]\n[shape.a.implicit]\nfield = \"a\"";
    UnsoundSurface: "Triangles must not cross, and must be near enough to the surface. Where parts of it touch or cross each other there are none. Where edges are very blunt, or many of them meet, all is made again with ever smaller triangles around that place; what is still not right after several tries is refused. Bodies that overlap or lie apart have a sound surface, as a union with a `blend` has; shapes of one field each, joined as solids, keep all sharp edges with the fewest triangles.",
        "" =>
        "[shape.a.implicit]\nfield = { union = { of = [{ sphere = { radius = 1 } }, { sphere = { radius = 1, center = [2, 0, 0] } }], blend = 0.3 } }";
    TooMuchWork: "A field is searched in cells, and asked at many places. Where bounds on it say nothing until cells are very small, or it has very many parts, this would not end soon. The usual reasons are a field that touches 0 without a change of sign, a small `search`, a box much larger than the body, a fine `tolerance`.",
        "[shape.a.implicit]\nfield = { formula = { f = \"= (x^2 + y^2 + z^2 - 1)^2\" } }\nwithin = { min = [-2, -2, -2], max = [2, 2, 2] }" =>
        "[shape.a.implicit]\nfield = { formula = { f = \"= x^2 + y^2 + z^2 - 1\" } }\nwithin = { min = [-2, -2, -2], max = [2, 2, 2] }";
    LimitPassed: "The asset would have more triangles, vertices or bytes than [limits] or the machine's owner allows. Nothing was made: the count is known before memory is taken.",
        "[limits]\ntriangles = 100\n[shape.a.sphere]\nradius = 1" => "[shape.a]\nsegments = 8\n[shape.a.sphere]\nradius = 1\n[limits]\ntriangles = 200";
    NothingToShow: "A document needs a shape, and where it has nodes at least one of them must show one.",
        "[material.clay]" => "[shape.a.sphere]\nradius = 1";
    MapSize: "A map needs at least two rows and two columns: a single one spans no area.",
        "[shape.a.height-map]\nmap = { grid = { rows = [[0, 1, 2]] } }\nsize = [1, 1]" => "[shape.a.height-map]\nmap = { grid = { rows = [[0, 1, 2], [1, 2, 3]] } }\nsize = [1, 1]";
    MapFile: "The file is not the grid of numbers that is asked for: an ASCII grid whose header or numbers are wrong, or a raw file whose length does not fit columns, rows and the size of its numbers.",
        "[shape.a.height-map]\nmap = { raw = { file = \"label.png\", columns = 3, rows = 3 } }\nsize = [1, 1]" => "[shape.a.height-map]\nmap = { grid = { rows = [[0, 1], [1, 2]] } }\nsize = [1, 1]";
    MapImage: "Maps are read from grey PNG pictures of 8 or 16 bits. Colors, palettes and transparency have no height; convert the picture to grey, best with 16 bits, since 256 steps show on smooth ground.",
        "[shape.a.height-map]\nmap = { image = { file = \"label.png\" } }\nsize = [1, 1]" => "[shape.a.height-map]\nmap = { grid = { rows = [[0, 1], [1, 2]] } }\nsize = [1, 1]";
    NoValue: "A sample of a map is marked as having no value, or is not a finite number. Nothing is filled in silently.",
        "[shape.a.height-map]\nmap = { formula = { f = \"= sqrt(x - 0.5)\" } }\nsize = [1, 1]" => "[shape.a.height-map]\nmap = { formula = { f = \"= sqrt(abs(x - 0.5))\" } }\nsize = [1, 1]";
    BelowBase: "A height map that is closed by a base lies above it everywhere. Lower the base, or raise the heights with `range`.",
        "[shape.a.height-map]\nmap = { grid = { rows = [[1, -1], [1, 2]] } }\nsize = [1, 1]\nclose = \"base\"" => "[shape.a.height-map]\nmap = { grid = { rows = [[1, -1], [1, 2]] } }\nsize = [1, 1]\nclose = \"base\"\nbase = -2";
    MapPoints: "Scattered points make a map when they are at different places and not all on one line.",
        "[shape.a.height-map]\nmap = { points = { points = [[0, 0, 1], [1, 1, 2], [2, 2, 3]] } }\nsize = [1, 1]" => "[shape.a.height-map]\nmap = { points = { points = [[0, 0, 1], [1, 1, 2], [0, 2, 3]] } }\nsize = [1, 1]";
    SplitParts: "Two parts of a split body on one plane that look away from each other are stitched together along the lines of their masks. Their maps are brought onto one grid for that, on which both are what they were; of very unequal numbers of samples it would be too fine. The first part has no parts before it that an operation could change.",
        "[shape.a.split]\nsize = [1, 1]\npart = [{ map = { noise = { columns = 4099, rows = 2 } }, range = [1, 2] }, { map = { noise = {} }, range = [1, 2], normal = [0, -1, 0] }]" => "[shape.a.split]\nsize = [1, 1]\npart = [{ map = { noise = {} }, range = [1, 2] }, { map = { noise = {} }, range = [1, 2], normal = [0, -1, 0] }]";
    MissingFeature: "Kiln was built without an optional part that the document needs. Cargo features turn such parts on: `csg` has the solid operations. The command line has all of them; a build script that leaves out the default features names those that it needs.",
        "" => "";
    NothingKept: "The masks of a height map keep the places where all of them hold. Where a map nowhere passes its threshold, or only touches it at single samples, no area is left. The message tells how far the map reaches.",
        "[shape.a.height-map]\nmap = { noise = {} }\nsize = [1, 1]\nmask = [{ map = { grid = { rows = [[0, 1], [1, 2]] } }, at-least = 3 }]" => "[shape.a.height-map]\nmap = { noise = {} }\nsize = [1, 1]\nmask = [{ map = { grid = { rows = [[0, 1], [1, 2]] } }, at-least = 1.5 }]";
    AssertionFailed: "What [assert] demands does not hold of the result. Nothing was written.",
        "[shape.a.box]\nsize = [1, 1, 1]\n[assert]\ntriangles = 10" => "[shape.a.box]\nsize = [1, 1, 1]\n[assert]\ntriangles = 12";
    UnknownFact: "Keys of [assert] are paths of the report: `triangles`, `shapes.NAME.area`, `totals.draw-calls`. With one shape its facts need no path.",
        "[shape.a.box]\nsize = [1, 1, 1]\n[assert]\ntrianglez = 12" => "[shape.a.box]\nsize = [1, 1, 1]\n[assert]\ntriangles = 12";
    TwoRoots: "The joints of a skeleton hang together in one tree: all but one of them, the root, have a parent.",
        "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 0, 0]\ntail = [0, 1, 0]\n[skeleton.s.joint.b]\nhead = [1, 0, 0]\ntail = [1, 1, 0]" =>
        "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 0, 0]\ntail = [0, 1, 0]\n[skeleton.s.joint.b]\nparent = \"a\"\nhead = [1, 0, 0]\ntail = [1, 1, 0]";
    NoBone: "A joint's rest frame has its y along the bone, from head to tail, so these must be apart.",
        "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 1, 0]\ntail = [0, 1, 0]" =>
        "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 0, 0]\ntail = [0, 1, 0]";
    SkinPlace: "A player puts the vertices of a skinned shape where its joints are and takes no notice of the node that shows it. So that node has no place of its own, the shape is shown, and it has one skin. A node can carry the whole: name it as the skeleton's parent.",
        "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 0, 0]\ntail = [0, 1, 0]\n[skin.k]\nshape = \"b\"\nskeleton = \"s\"\nweights = \"rigid\"\n[node.n]\nshape = \"b\"\nat = [0, 1, 0]" =>
        "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 0, 0]\ntail = [0, 1, 0]\n[skin.k]\nshape = \"b\"\nskeleton = \"s\"\nweights = \"rigid\"\n[node.n]\nshape = \"b\"";
    Unweighted: "Each vertex of a skinned shape is carried by at least one joint. With envelopes a vertex may lie beyond the radius and falloff of all of them; the message counts such vertices and tells where one is.",
        "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 0, 0]\ntail = [0, 1, 0]\nfalloff = 0.1\n[skin.k]\nshape = \"b\"\nskeleton = \"s\"" =>
        "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 0, 0]\ntail = [0, 1, 0]\nradius = 1\n[skin.k]\nshape = \"b\"\nskeleton = \"s\"";
    BadTrack: "A clip moves something, each part of a node or joint has at most one track in it, joints slide only along axes that have ranges, and only nodes are moved along curves.",
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[clip.c]\nduration = 1" =>
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[[clip.c.track]]\nnode = \"a\"\npath = \"scale\"\nkeys = [{ at = 0, value = 1 }, { at = 1, value = 2 }]";
    KeyOrder: "Keys stand in the order of their times, at least 0.1 ms apart and within the clip; events lie within the clip too. A curve that is a law of motion runs onward in x.",
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[[clip.c.track]]\nnode = \"a\"\npath = \"scale\"\nkeys = [{ at = 1, value = 1 }, { at = 0, value = 2 }]" =>
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[[clip.c.track]]\nnode = \"a\"\npath = \"scale\"\nkeys = [{ at = 0, value = 2 }, { at = 1, value = 1 }]";
    KeyValue: "All keys of a track have as many numbers: a translation three, or one along an axis; a rotation one about an axis, three angles, or a quaternion of length 1; a scale one or three.",
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[[clip.c.track]]\nnode = \"a\"\npath = \"rotation\"\nkeys = [{ at = 0, value = 1 }, { at = 1, value = 2 }]" =>
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[[clip.c.track]]\nnode = \"a\"\npath = \"rotation\"\naxis = \"y\"\nkeys = [{ at = 0, value = 1 }, { at = 1, value = 2 }]";
    NoTime: "A clip lasts from 0 to its duration, or else to its last key. With one key at 0, or with formulas alone, there is no time to move in.",
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[[clip.c.track]]\nnode = \"a\"\npath = \"scale\"\nformula = \"= 1 + t\"" =>
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[clip.c]\nduration = 1\n[[clip.c.track]]\nnode = \"a\"\npath = \"scale\"\nformula = \"= 1 + t\"";
    BeyondLimit: "A joint turns or slides beyond the range of an axis. A rotation is taken apart into a swing about x, then one about z, then a twist about y, the bone. With `limits = \"clamp\"` in the clip angles are brought into their ranges instead.",
        "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 0, 0]\ntail = [0, 1, 0]\nlimits = { x = [0, 90] }\n[[clip.c.track]]\njoint = \"a\"\npath = \"rotation\"\naxis = \"x\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 100 }]" =>
        "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 0, 0]\ntail = [0, 1, 0]\nlimits = { x = [0, 90] }\n[[clip.c.track]]\njoint = \"a\"\npath = \"rotation\"\naxis = \"x\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 80 }]";
    LoopSeam: "A clip that is played again and again jumps where its end and its start differ.",
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[clip.c]\nloop = true\n[[clip.c.track]]\nnode = \"a\"\npath = \"scale\"\nkeys = [{ at = 0, value = 1 }, { at = 1, value = 2 }]" =>
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[clip.c]\nloop = true\n[[clip.c.track]]\nnode = \"a\"\npath = \"scale\"\nkeys = [{ at = 0, value = 1 }, { at = 1, value = 2 }, { at = 2, value = 1 }]";
    PastTheEnd: "A node that moves along an open curve at given speeds must not be past its end before the clip is over. On a closed curve it goes round.",
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[clip.c]\nduration = 2\n[[clip.c.track]]\nnode = \"a\"\nalong = { line = { from = [0, 0], to = [1, 0] } }\nspeed = [{ at = 0, value = 1 }]" =>
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[clip.c]\nduration = 2\n[[clip.c.track]]\nnode = \"a\"\nalong = { line = { from = [0, 0], to = [1, 0] } }\nspeed = [{ at = 0, value = 0.5 }]";
    Unreached: "By inverse kinematics joints are turned, within their limits, so that a point comes to its target. This one does not: it is further away than the bones are long, or the limits do not let them bend so. What is baked comes as near as was found.",
        "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 0, 0]\ntail = [0, 1, 0]\n[skeleton.s.joint.b]\nparent = \"a\"\ntail = [0, 2, 0]\n[clip.c]\nduration = 1\n[[clip.c.reach]]\njoint = \"b\"\ntarget = [3, 0, 0]" =>
        "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.joint.a]\nhead = [0, 0, 0]\ntail = [0, 1, 0]\n[skeleton.s.joint.b]\nparent = \"a\"\ntail = [0, 2, 0]\n[clip.c]\nduration = 1\n[[clip.c.reach]]\njoint = \"b\"\ntarget = [1, 1, 0]";
    LooseMotion: "The motion changes faster than it is sampled, or jumps: between two samples a vertex is further from its exact place than the tolerance. Jumps belong into keys with `between = \"step\"`.",
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[clip.c]\nduration = 1\n[[clip.c.track]]\nnode = \"a\"\npath = \"translation\"\naxis = \"x\"\nformula = \"= if(t < 0.503, 0, 1)\"" =>
        "[node.a]\nshape = \"b\"\n[shape.b.box]\nsize = [1, 1, 1]\n[clip.c]\nduration = 1\n[[clip.c.track]]\nnode = \"a\"\npath = \"translation\"\naxis = \"x\"\nbetween = \"step\"\nkeys = [{ at = 0, value = 0 }, { at = 0.503, value = 1 }]";
    BadPatch: "A patch is a polygon with area: its corners are apart and stand in their order around it, so that sides do not cross or run back. Flat faces have their corners on one plane; sides on a ball are the shortest great circles, which antipodal points do not have.",
        "[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\nfaces = [[0, 2, 1, 3]]" =>
        "[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]\nfaces = [[0, 1, 2, 3]]";
    PatchSight: "Faces about a center look away from it, and each spans less than half of the directions. All points of spherical faces are equally far from the center.",
        "[shape.a.perturbed]\npoints = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\nfaces = [[0, 2, 1]]\ncenter = [0, 0, 0]\nspherical = true" =>
        "[shape.a.perturbed]\npoints = [[1, 0, 0], [0, 1, 0], [0, 0, 1]]\nfaces = [[0, 1, 2]]\ncenter = [0, 0, 0]\nspherical = true";
    PatchBump: "Bumps of patches are squares of quadrics, or of quadrics with bumps: of those all bounds are known that prove the surface. Distances to bodies, formulas and skeletons have a field of their own.",
        "[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nfaces = [[0, 1, 2]]\nbumps = [{ field = { sphere = { radius = 0.2, center = [0.3, 0.3, 0] } }, factor = 0.1 }]" =>
        "[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nfaces = [[0, 1, 2]]\nbumps = [{ field = { quadric = { xx = 25, yy = 25, zz = 25, constant = -1 }, at = [0.3, 0.3, 0] }, factor = 0.1 }]";
    PatchSide: "Faces are joined by naming the same two points. A side belongs to one face, where the skin is open, or to two that run along it in opposite directions, so that both look outward.",
        "[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]\nfaces = [[0, 1, 2], [1, 2, 3]]" =>
        "[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]\nfaces = [[0, 1, 2], [1, 3, 2]]";
    PatchesPart: "Neighbors share one line along their side. Faces that look apart, each along its own normal, grow apart where a bump lies over the side; and a bump for one of them alone parts it from the other. About a `center` bumps for all faces keep the skin closed.",
        "[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]\nfaces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]\nbumps = [{ field = { quadric = { xx = 25, yy = 25, zz = 25, constant = -1 }, at = [1, 0.5, 1] }, factor = 0.1 }]" =>
        "[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]\nfaces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]\ncenter = [0.5, 0.5, 0.5]\nbumps = [{ field = { quadric = { xx = 25, yy = 25, zz = 25, constant = -1 }, at = [1, 0.5, 1] }, factor = 0.1 }]";
    PatchReach: "The surface is looked for near its face: as far as its bumps go, or as far as `reach` says. A bump that grows without end has none, and a hollow must not reach the center.",
        "[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nfaces = [[0, 1, 2]]\nreach = 0.05\nbumps = [{ field = { quadric = { xx = 25, yy = 25, zz = 25, constant = -1 }, at = [0.3, 0.3, 0] }, factor = 0.1 }]" =>
        "[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\nfaces = [[0, 1, 2]]\nreach = 0.2\nbumps = [{ field = { quadric = { xx = 25, yy = 25, zz = 25, constant = -1 }, at = [0.3, 0.3, 0] }, factor = 0.1 }]";
    PatchOverhang: "Where a ray meets the surface more than once no plane coordinates cover it. Of a single convex face, and of a closed skin about a center whose bumps are for all faces, the solid below is made instead.",
        "[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]\nfaces = [[0, 1, 2], [1, 3, 2]]\nbumps = [{ field = { quadric = { xx = 25, yy = 25, zz = 25, constant = -1 }, at = [0.5, 0.5, 0.15] }, factor = 2 }]" =>
        "[shape.a.perturbed]\npoints = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]\nfaces = [[0, 1, 2], [1, 3, 2]]\nbumps = [{ field = { quadric = { xx = 25, yy = 25, zz = 25, constant = -1 }, at = [0.5, 0.5, 0.15] }, factor = 0.1 }]";
    DeepHeights: "A surface is moved along its normals so far that it runs through itself: inward beyond the centers of its curvature, where normals meet, or over into a part that lies opposite. The message has the place.",
        "[shape.a.height-map]\nmap = { grid = { rows = [[0, 0], [-2, -2], [0, 0]] } }\non = { sphere = { radius = 1 } }" => "[shape.a.height-map]\nmap = { grid = { rows = [[0, 0], [-0.5, -0.5], [0, 0]] } }\non = { sphere = { radius = 1 } }";
    BadBase: "Heights stand on one smooth surface with normals: one over parameters u and v, without edges inside, without a twist, and with area everywhere but at poles on its sides.",
        "[shape.a.height-map]\nmap = { noise = {} }\non = { surface = { of = { box = { size = [1, 1, 1] } } } }" => "[shape.a.height-map]\nmap = { noise = {} }\nrange = [0, 0.1]\non = { surface = { of = { revolve = { profile = { line = { from = [1, 0], to = [1, 2] } } } } } }";
    UnequalPole: "A row of a map over a sphere or an ellipsoid is one point at 90 and at -90 degrees of latitude, and so is a side of a surface that ends in a point. There is one height; where the samples of the row differ, their mean stands, and around it the ground is steep.",
        "[shape.a.height-map]\nmap = { formula = { f = \"= 0.1 * x\" } }\non = { sphere = { radius = 1, latitude = [90, 0] } }" => "[shape.a.height-map]\nmap = { formula = { f = \"= 0.1 * x * y * (1 - y)\" } }\non = { sphere = { radius = 1 } }";
    TornHeights: "A shape that is moved along its normals by heights would tear: where its texture has a seam, the map has other heights on the one side than on the other, or the height jumps in one place. Projections that depend on the place alone have no seams.",
        "[shape.a.displace]\nof = { box = { size = [1, 1, 1] } }\nmap = { formula = { f = \"= 0.1 * x\" } }" => "[shape.a.displace]\nof = { box = { size = [1, 1, 1] } }\nmap = { formula = { f = \"= 0.1 * x\" } }\nprojection = \"y\"";
    NormalMap: "The normals of a shape at full resolution are drawn into a picture over its texture coordinates, so these must lie between 0 and 1 and cover no place twice; and the shape must be shown by itself, with its own material.",
        "[shape.a.displace]\nof = { box = { size = [1, 1, 1] } }\nformula = \"= 0.01 * sin(x * 720)\"\nbake-normal-map = 64" => "[shape.a.displace]\nof = { plane = { size = [1, 1] } }\nformula = \"= 0.01 * sin(x * 720)\"\nbake-normal-map = 64";
    FewerLevels: "A level of detail has no more than nine tenths of the triangles of the one before, is closed where the shape is, and has as many parts with as many holes. Where the surface cannot be cut so coarsely, triangles of the level before are taken away; where that does not help either, the level is left out, and the shape has fewer than the others.",
        "[lod]\nlevels = 8\n[shape.a]\nsegments = [64, 32]\n[shape.a.sphere]\nradius = 1" =>
        "[lod]\nlevels = 4\n[shape.a]\nsegments = [64, 32]\n[shape.a.sphere]\nradius = 1";
    BadLevels: "`tolerances` of `[lod]` are those of the coarser levels, from the second one on. Each must be greater than the one before.",
        "[lod]\ntolerances = [0.05, 0.01]\n[shape.a.sphere]\nradius = 1" =>
        "[lod]\ntolerances = [0.01, 0.05]\n[shape.a.sphere]\nradius = 1";
    CoarseGrid: "Profiles of whole numbers put all positions of a model on one grid with 65536 lines along each axis. Where a model is so large that this would move points further than its tolerance, its positions stay floats of single precision, and the file is larger.",
        "tolerance = 1e-5\n[output]\nprofiles = [\"quantized\"]\n[shape.a.cylinder]\nradius = 0.5\nheight = 1" =>
        "tolerance = 1e-3\n[output]\nprofiles = [\"quantized\"]\n[shape.a.cylinder]\nradius = 0.5\nheight = 1";
    SameFile: "The file of a variant is called NAME.VARIANT.glb, that of a profile NAME.PROFILE.glb. A variant with the name of a profile would be written over it.",
        "[output]\nprofiles = [\"core\", \"web\"]\n[shape.a.box]\nsize = [1, 1, 1]\n[variant.web.shape.a.box]\nsize = [2, 1, 1]" =>
        "[output]\nprofiles = [\"core\", \"web\"]\n[shape.a.box]\nsize = [1, 1, 1]\n[variant.wide.shape.a.box]\nsize = [2, 1, 1]";
    MorphTopology: "A state of a shape moves its vertices, so it has the same triangles. Surfaces over parameters (revolve, extrude, sweep, patches) correspond piece by piece; polygons and cages where they are the same over other points. Heights over one rectangle, closed alike, correspond along upright rays, whole ellipsoids along those from their centers, perturbed patches over the same faces along the rays of these. Fields, solids and what is cut off have no such rays: where a part grows out or a hole opens, no point is the same, and they morph only where they happen to be cut alike.",
        "[parameters]\nsides = 4\n[shape.a.array]\nof = { box = { size = [1, 1, 1] } }\ncount = \"= sides\"\noffset = [2, 0, 0]\n[morph.a.more]\nwith = { sides = 5 }" =>
        "[parameters]\nhigh = 1\n[shape.a.array]\nof = { box = { size = [1, \"= high\", 1] } }\ncount = 4\noffset = [2, 0, 0]\n[morph.a.higher]\nwith = { high = 2 }";
    BadMorph: "A shape that morphs is shown by a node, as itself and made of triangles; each of its states can be made and is another shape than it.",
        "[shape.a.box]\nsize = [1, 1, 1]\n[morph.a.same]\nshape = \"a\"" =>
        "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.box]\nsize = [1, 2, 1]\n[morph.a.high]\nshape = \"b\"";
    MixedWeights: "All weights of a mesh are one track of a file, which jumps from key to key or runs straight. In a clip the weights of a node do one or the other.",
        "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.box]\nsize = [1, 2, 1]\n[shape.c.box]\nsize = [2, 1, 1]\n[morph.a.high]\nshape = \"b\"\n[morph.a.wide]\nshape = \"c\"\n[[clip.c.track]]\nmorph = \"a.high\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 1 }]\n[[clip.c.track]]\nmorph = \"a.wide\"\nbetween = \"step\"\nkeys = [{ at = 0, value = 0 }, { at = 0.5, value = 1 }]" =>
        "[shape.a.box]\nsize = [1, 1, 1]\n[shape.b.box]\nsize = [1, 2, 1]\n[shape.c.box]\nsize = [2, 1, 1]\n[morph.a.high]\nshape = \"b\"\n[morph.a.wide]\nshape = \"c\"\n[[clip.c.track]]\nmorph = \"a.high\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 1 }]\n[[clip.c.track]]\nmorph = \"a.wide\"\nkeys = [{ at = 0.499, value = 0 }, { at = 0.5, value = 1 }]";
    UnseenBones: "With `weights = \"heat\"` bones heat the skin that they are nearest to and that they see, and the skin carries heat along. A part that hangs together with no other, and sees none of its nearest bones because other faces are between, stays cold: a sleeve around an arm, a ball beside it.",
        "[shape.b.group]\nof = [\"arm\", \"sleeve\"]\n[shape.arm.tube]\nradius = 0.2\ninner-radius = 0.1\nheight = 2\n[shape.sleeve.tube]\nradius = 0.4\ninner-radius = 0.3\nheight = 1\n[skeleton.s.joint.a]\nhead = [0, -1, 0]\ntail = [0, 1, 0]\n[skin.k]\nshape = \"b\"\nskeleton = \"s\"\nweights = \"heat\"" =>
        "[shape.b.group]\nof = [\"arm\", \"sleeve\"]\n[shape.arm.tube]\nradius = 0.2\ninner-radius = 0.1\nheight = 2\n[shape.sleeve.tube]\nradius = 0.4\ninner-radius = 0.3\nheight = 1\n[skeleton.s.joint.a]\nhead = [0, -1, 0]\ntail = [0, 1, 0]\n[skeleton.s.joint.sleeve]\nparent = \"a\"\nhead = [0.35, 0, 0]\ntail = [0.35, 0.5, 0]\n[skin.k]\nshape = \"b\"\nskeleton = \"s\"\nweights = \"heat\"";
    StretchedMotion: "A joint of a skeleton has its y along its bone; one of a glTF file has axes of its own. Turns, moves and even scales are carried over from the one to the other. A scale that is not the same along x, y and z, or a joint that is bound mirrored, would shear, which a node of a glTF file cannot do.",
        "" => "";
    ColliderPlace: "A collider belongs to the nodes that show its shape. One for a shape that no node shows, such as a simple stand-in for another shape, says with `node` where it belongs.",
        "[shape.a.sphere]\nradius = 1\n[shape.b.box]\nsize = [1, 1, 1]\n[node.n]\nshape = \"a\"\n[collider.c]\nshape = \"b\"" =>
        "[shape.a.sphere]\nradius = 1\n[shape.b.box]\nsize = [1, 1, 1]\n[node.n]\nshape = \"a\"\n[collider.c]\nshape = \"b\"\nnode = \"n\"";
    FlatCollider: "A body that things bounce off encloses a volume. A flat shape has none: a thin box in its place serves better.",
        "[shape.a.disk]\nradius = 1\n[collider.c]\nshape = \"a\"" =>
        "[shape.a.cylinder]\nradius = 1\nheight = 0.02\n[collider.c]\nshape = \"a\"";
    EngineMaterials: "What a material has beyond color, metal, roughness and light is an extension of the format that files use and never require: engines that do not know it draw the rest. A warning. Bevy draws the pictures of coats, specular, anisotropy and transmission where its features `pbr_multi_layer_material_textures`, `pbr_specular_textures`, `pbr_anisotropy_texture` and `pbr_transmission_textures` are on.",
        "[output]\nprofiles = [\"bevy\"]\n[shape.a]\nmaterial = \"m\"\n[shape.a.sphere]\nradius = 1\n[material.m]\nsheen = { color = \"#402020\" }" =>
        "[output]\nprofiles = [\"three\"]\n[shape.a]\nmaterial = \"m\"\n[shape.a.sphere]\nradius = 1\n[material.m]\nsheen = { color = \"#402020\" }";
    EmptyRoot: "Each of the `roots` in kiln.toml is a document, or a folder that has documents in it or in its folders. Files whose names do not end in `.toml`, or begin with a dot, are none.",
        "" => "";
    OverlappingRoots: "Each document of a project belongs to one root, for its output has the place that it has below that. A root that lies in another one, or is named twice, would bake its documents twice.",
        "" => "";
    SameOutput: "An output is called as its document is and lies where that lies below its root: specs/chess/pawn.toml becomes chess/pawn.glb for the root `specs`. Two roots may have documents of one name; they would be written over each other. Upper and lower case count as the same, as on some file systems.",
        "" => "";
    ProjectParameter: "`[parameters]` in kiln.toml sets parameters of all documents that have them. A name that no document has is likely misspelt.",
        "" => "";
    EngineLevels: "A profile for an engine has levels of detail in the form that its loader takes: by `MSFT_lod` for Babylon.js and, with a plugin, three.js; in files of their own for the others, whose loaders show all nodes of a scene and know no levels.",
        "[output]\nprofiles = [\"bevy\"]\n[lod]\nlevels = 2\nform = \"msft-lod\"\n[shape.a.sphere]\nradius = 1" =>
        "[output]\nprofiles = [\"bevy\"]\n[lod]\nlevels = 2\n[shape.a.sphere]\nradius = 1";
    EngineColliders: "Engines make bodies of what their loaders know: Godot of names and of the `OMI` extensions, Unreal of names, games in the others of numbers in `extras`.",
        "[output]\nprofiles = [\"unreal\"]\ncolliders = \"omi\"\n[shape.a.sphere]\nradius = 1\n[collider.c]\nshape = \"a\"" =>
        "[output]\nprofiles = [\"unreal\"]\n[shape.a.sphere]\nradius = 1\n[collider.c]\nshape = \"a\"";
    EngineName: "Godot's importer acts upon the ends of names: a node whose name ends in `-col` gets a body, one in `-noimp` is left out, a motion that begins or ends with `loop` is repeated. In the profile `godot` a name that happens to end so is told.",
        "[output]\nprofiles = [\"godot\"]\n[shape.front-wheel.sphere]\nradius = 1" =>
        "[output]\nprofiles = [\"godot\"]\n[shape.wheel-front.sphere]\nradius = 1";
    NoParts: "A shape is cut into convex parts as a solid: it must be closed, with faces that look outward, and in no more than 256 bodies.",
        "[shape.a.revolve]\nprofile = { polyline = { points = [[1, 0], [1, 2]] } }\ncaps = false\n[collider.c]\nshape = \"a\"\nfit = \"parts\"" =>
        "[shape.a.revolve]\nprofile = { polyline = { points = [[0, 0], [1, 0], [1, 2], [0, 2]] } }\n[collider.c]\nshape = \"a\"\nfit = \"parts\"";
    RoughParts: "The convex parts are as many as `parts` allows, and some of them fill hollows of the shape more deeply than `concavity` allows. A warning.",
        "tolerance = 0.02\n[shape.a.torus]\nradius = 1\ntube-radius = 0.2\n[collider.c]\nshape = \"a\"\nfit = \"parts\"\nparts = 2" =>
        "tolerance = 0.02\n[shape.a.torus]\nradius = 1\ntube-radius = 0.2\n[collider.c]\nshape = \"a\"\nfit = \"parts\"\nparts = 12\nconcavity = 0.1";
    NoLightmap: "A shape is cut into pieces that lie flat on one picture, apart from each other. Where the picture is too small for its pieces and what lies between them, or the shape has more than 200,000 triangles, there is no such layout.",
        "[shape.a]\nlightmap = { size = 16, padding = 7 }\n[shape.a.box]\nsize = [1, 1, 1]" =>
        "[shape.a]\nlightmap = { size = 256, padding = 2 }\n[shape.a.box]\nsize = [1, 1, 1]";
    UnevenScale: "All that a file holds is made larger by one number. Bodies of physics, lights and the bones of skins cannot be stretched along one axis alone.",
        "[output]\nscale = [1, 2, 1]\n[shape.a.sphere]\nradius = 1" =>
        "[output]\nscale = 100\n[shape.a.sphere]\nradius = 1";
    AttributeName: "The format has names of its own for attributes of vertices. All others begin with an underscore, and consist of capital letters, digits and underscores.",
        "[shape.a]\nattributes = { wind = \"= y\" }\n[shape.a.sphere]\nradius = 1" =>
        "[shape.a]\nattributes = { _WIND = \"= y\" }\n[shape.a.sphere]\nradius = 1";
    UnseenAttribute: "Attributes of vertices belong to the shape that a node shows, with all its parts: a file has them for whole meshes. On a shape that is only a part of others they would be lost.",
        "[shape.a.group]\nof = [\"b\"]\n[shape.b]\nattributes = { _WIND = \"= y\" }\n[shape.b.sphere]\nradius = 1" =>
        "[shape.a]\nattributes = { _WIND = \"= y\" }\n[shape.a.group]\nof = [\"b\"]\n[shape.b.sphere]\nradius = 1";
    EngineAttributes: "Attributes with names of their own are read by three.js, Blender and, where the game registers them, Bevy. The importers of Godot, Unreal, Unity and Babylon.js leave them out, and that of Blender 4.5 fails on more than one of a mesh.",
        "[output]\nprofiles = [\"godot\"]\n[shape.a]\nattributes = { _WIND = \"= y\" }\n[shape.a.sphere]\nradius = 1" =>
        "[output]\nprofiles = [\"bevy\"]\n[shape.a]\nattributes = { _WIND = \"= y\" }\n[shape.a.sphere]\nradius = 1";
    AimCircle: "A node is turned to what it looks at, and turns what it carries. So it cannot look at what it carries itself, nor can two nodes each carry what the other looks at.",
        "[shape.a.sphere]\nradius = 1\n[node.n]\nshape = \"a\"\naim = \"m\"\n[node.m]\nparent = \"n\"\nat = [1, 0, 0]" =>
        "[shape.a.sphere]\nradius = 1\n[node.n]\nshape = \"a\"\naim = \"m\"\n[node.m]\nat = [1, 0, 0]";
    AimAtItself: "From a place there is no direction to that place itself.",
        "[shape.a.sphere]\nradius = 1\n[node.n]\nshape = \"a\"\naim = [0, 0, 0]" =>
        "[shape.a.sphere]\nradius = 1\n[node.n]\nshape = \"a\"\naim = [0, 0, 1]";
    EngineProperties: "Properties of materials, lights and cameras change by the extension `KHR_animation_pointer`. A loader that does not know it is to leave such tracks out; Bevy's opens no file that has one, so that the profile `bevy` leaves them out. A warning.",
        "[output]\nprofiles = [\"bevy\"]\n[shape.a]\nmaterial = \"m\"\n[shape.a.box]\nsize = [1, 1, 1]\n[material.m]\ncolor = \"#ff0000\"\n[[clip.c.track]]\nmaterial = \"m\"\npath = \"roughness\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 1 }]" =>
        "[shape.a]\nmaterial = \"m\"\n[shape.a.box]\nsize = [1, 1, 1]\n[material.m]\ncolor = \"#ff0000\"\n[[clip.c.track]]\nmaterial = \"m\"\npath = \"roughness\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 1 }]";
    NoProperty: "A track changes a property that what it names has: a node's light or camera has some, a material others, of which the strength of a texture is one only where there is that texture. Joints have none.",
        "[shape.a]\nmaterial = \"m\"\n[shape.a.box]\nsize = [1, 1, 1]\n[material.m]\ncolor = \"#ff0000\"\n[[clip.c.track]]\nmaterial = \"m\"\npath = \"normal-scale\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 1 }]" =>
        "[shape.a]\nmaterial = \"m\"\n[shape.a.box]\nsize = [1, 1, 1]\n[material.m]\ncolor = \"#ff0000\"\n[[clip.c.track]]\nmaterial = \"m\"\npath = \"roughness\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 1 }]";
    PropertyRange: "Colors, opacity, metal and roughness are from 0 to 1, what lights and cameras have is not negative. Between keys of a cubic a value may go beyond them. With `limits = \"clamp\"` in the clip it is brought into its range instead.",
        "[shape.a]\nmaterial = \"m\"\n[shape.a.box]\nsize = [1, 1, 1]\n[material.m]\ncolor = \"#ff0000\"\n[[clip.c.track]]\nmaterial = \"m\"\npath = \"roughness\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 2 }]" =>
        "[shape.a]\nmaterial = \"m\"\n[shape.a.box]\nsize = [1, 1, 1]\n[material.m]\ncolor = \"#ff0000\"\n[[clip.c.track]]\nmaterial = \"m\"\npath = \"roughness\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 1 }]";
    UnseenChange: "The material of a track is on nothing that is shown, so that nothing is written of it. A warning.",
        "[shape.a.box]\nsize = [1, 1, 1]\n[material.m]\ncolor = \"#ff0000\"\n[[clip.c.track]]\nmaterial = \"m\"\npath = \"roughness\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 1 }]" =>
        "[shape.a]\nmaterial = \"m\"\n[shape.a.box]\nsize = [1, 1, 1]\n[material.m]\ncolor = \"#ff0000\"\n[[clip.c.track]]\nmaterial = \"m\"\npath = \"roughness\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 1 }]";
}
