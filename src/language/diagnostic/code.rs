//! The stable codes of diagnostics.

macro_rules! codes {
    ($($(#[doc = $doc:literal])+ $name:ident = $text:literal;)+) => {
        /// A stable code: it keeps its meaning from release to release. `kiln explain CODE` tells more.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Code {$(
            $(#[doc = $doc])+
            $name,
        )+}

        impl Code {
            /// All codes, in order.
            pub const ALL: &[Self] = &[$(Self::$name,)+];

            /// The code as it is printed: `K0101`.
            #[must_use]
            pub const fn text(self) -> &'static str {
                match self {$( Self::$name => $text, )+}
            }

            /// What the code means, in one line.
            #[must_use]
            pub fn title(self) -> &'static str {
                match self {$( Self::$name => concat!($($doc),+).trim(), )+}
            }

            /// The code that is printed so; upper and lower case alike.
            #[must_use]
            pub fn parse(text: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|code| code.text().eq_ignore_ascii_case(text))
            }
        }
    };
}

codes! {
    /// a file cannot be found
    FileMissing = "K0001";
    /// a file cannot be read
    FileUnreadable = "K0002";
    /// a path leaves the project
    OutsideRoot = "K0003";
    /// a document is not UTF-8 text
    NotText = "K0004";
    /// the text is not TOML 1.0
    Syntax = "K0005";
    /// arrays or tables are nested too deeply
    TooDeep = "K0006";
    /// a document is too large
    TooLarge = "K0007";
    /// a bracket is never closed
    Unclosed = "K0008";

    /// a table has a key that it does not know
    UnknownField = "K0101";
    /// a table lacks a key that it needs
    MissingField = "K0102";
    /// a definition says no kind
    NoKind = "K0103";
    /// a definition says more than one kind
    ManyKinds = "K0104";
    /// two keys exclude each other
    Conflict = "K0105";

    /// a value is of the wrong type
    WrongType = "K0201";
    /// an array has too few or too many items
    WrongLength = "K0202";
    /// a number is out of its range
    OutOfRange = "K0203";
    /// a number is infinite, not a number, or beyond what can be computed with
    NotFinite = "K0204";
    /// a word is none of those that are known here
    UnknownChoice = "K0205";
    /// a text is not of the form that is asked for
    Malformed = "K0206";
    /// a name is not in kebab-case
    BadName = "K0207";

    /// a name is not defined
    UnknownName = "K0301";
    /// a name is defined, but as something else
    WrongFamily = "K0302";
    /// definitions refer to each other in a circle
    Cycle = "K0303";
    /// a name is defined twice
    DuplicateName = "K0304";
    /// a parameter is never used
    UnusedParameter = "K0305";
    /// a document shows nothing
    NothingToBake = "K0306";

    /// an expression cannot be read
    ExpressionSyntax = "K0401";
    /// an expression names something that is not a parameter
    UnknownVariable = "K0402";
    /// an expression calls a function that does not exist
    UnknownFunction = "K0403";
    /// an operation is given a value of the wrong type
    ExpressionType = "K0404";
    /// a function is given too few or too many arguments
    ArgumentCount = "K0405";
    /// an expression has no finite value
    ExpressionValue = "K0406";
    /// an expression is too deep, too long or takes too many steps
    ExpressionLimit = "K0407";
    /// parameters are computed from each other in a circle
    ParameterCycle = "K0408";
    /// an override does not fit the parameter
    BadOverride = "K0409";
    /// a parameter has the name of something built in
    ReservedName = "K0410";

    /// documents include each other in a circle
    IncludeCycle = "K0501";
    /// an included document states another unit or axis
    IncludeConflict = "K0502";
    /// a variant is not defined
    UnknownVariant = "K0503";
    /// a limit is raised where it may only be lowered
    LimitRaised = "K0504";

    /// consecutive points are equal
    RepeatedPoints = "K0601";
    /// the points or angles determine no curve
    Degenerate = "K0602";
    /// the number of items does not fit the other fields
    WrongCount = "K0603";
    /// numbers do not increase
    NotIncreasing = "K0604";
    /// knots decrease, or differ by almost nothing
    KnotOrder = "K0605";
    /// a knot is repeated too often
    KnotRepeated = "K0606";
    /// a weight is negative, or too little weight is left to hold the curve
    BadWeight = "K0607";
    /// there are too few points for the degree
    FewPoints = "K0608";
    /// a tangent has no length
    ZeroTangent = "K0609";
    /// a tension for which no smooth limit is proved
    TensionRange = "K0610";
    /// pieces of a curve do not meet
    PiecesApart = "K0611";
    /// a formula has no finite value somewhere in its range
    FormulaValue = "K0615";
    /// a formula jumps where a curve must be one piece
    FormulaJump = "K0616";
    /// a formula changes too often to be followed
    FormulaWild = "K0617";
    /// an SVG path cannot be read
    SvgSyntax = "K0620";
    /// a curve has several parts where one is needed
    ManyParts = "K0621";
    /// a curve has no part of that number
    NoPart = "K0622";
    /// a formula is nowhere zero
    NoZero = "K0623";
    /// the zeros of a formula are no smooth curve
    SingularCurve = "K0624";

    /// a face names a point that does not exist
    FaceIndex = "K0701";
    /// a face has fewer than three different corners
    FaceCorners = "K0702";

    /// a profile reaches across the axis it is turned about
    AcrossAxis = "K0801";
    /// a curve is open where a closed one is needed
    OpenProfile = "K0802";
    /// an outline crosses itself
    SelfCrossing = "K0803";
    /// an outline encloses no area
    NoArea = "K0804";
    /// a joint that is declared smooth is not
    BrokenJoint = "K0805";
    /// a path turns back on itself
    Reversal = "K0806";
    /// a profile is not flat in the x, y plane
    NotFlat = "K0807";
    /// a hole does not lie inside its outline
    BadHole = "K0808";
    /// a section is too wide for the bends of its path
    TightBend = "K0809";
    /// polygons do not make a mesh
    BadMesh = "K0810";
    /// positions cannot be stored as exactly as the tolerance asks
    BeyondPrecision = "K0811";
    /// a path runs along the direction that is to be up
    AlongUp = "K0812";
    /// a section does not come back to itself around a closed path
    UnmetSeam = "K0813";
    /// a curve of factors does not run from 0 to 1
    BadFactors = "K0814";
    /// profiles of one section are closed and open
    MixedProfiles = "K0815";
    /// a profile that rises runs along the axis
    AlongAxis = "K0816";
    /// a turn of a screw reaches into the next
    TurnsMeet = "K0817";
    /// a sweep runs into another part of itself
    SelfOverlap = "K0818";
    /// a shape is longer than the path it is laid along
    LongerThanPath = "K0819";

    /// an open and a closed curve cannot be joined
    OpenAndClosed = "K0820";
    /// curves that a surface should lie between are the same
    Coincident = "K0821";
    /// an end cannot be closed by a flat face
    NoFlatEnd = "K0822";
    /// a shape would fold over itself
    FoldsOver = "K0823";
    /// a map has no length to act on
    NoLength = "K0824";
    /// a path has a corner where it must be smooth
    CorneredPath = "K0825";
    /// a profile does not lie in one plane
    NoPlane = "K0826";
    /// a measure of a shape does not fit its other measures
    DoesNotFit = "K0830";
    /// a face crosses itself
    FoldedFace = "K0831";
    /// a face has no area
    FlatFace = "K0832";
    /// a hole lies in no outline
    StrayHole = "K0833";
    /// lines cannot show a texture
    TexturedWire = "K0834";

    /// parts of a profile cross or touch each other
    PartsMeet = "K0840";
    /// nothing is left of a profile
    NothingLeft = "K0841";
    /// two outlines touch, and it is unclear whether they cross
    UnclearContact = "K0842";
    /// a corner has no room for what is asked
    NoRoom = "K0843";
    /// a curve has no such corner
    NoCorner = "K0844";
    /// an outline is too narrow for walls that lean in so far
    TooNarrow = "K0845";

    /// a file cannot be imported
    ImportFailed = "K0851";
    /// parts of an imported file are left out
    ImportNote = "K0852";
    /// the format of a file is not supported
    UnsupportedFormat = "K0853";
    /// an image cannot be used
    BadImage = "K0854";
    /// an imported file has no group or material of that name
    UnknownPart = "K0855";

    /// rows of a grid differ in length
    UnevenRows = "K0860";
    /// a patch names a point that does not exist
    PatchIndex = "K0861";
    /// a patch has too few or too many points
    PatchPoints = "K0862";
    /// a grid does not hold whole patches
    PatchGrid = "K0863";
    /// patches that follow each other do not meet
    PatchGap = "K0864";
    /// patches do not join as smoothly as declared
    BrokenSeam = "K0865";
    /// sides of a patch do not meet
    OpenSides = "K0870";
    /// derivatives at a corner of a patch contradict each other
    CornerConflict = "K0871";
    /// curves make no network
    BadNetwork = "K0872";
    /// an equation has no surface
    NoQuadric = "K0873";
    /// a surface goes on without end
    EndlessQuadric = "K0874";
    /// a shape is not one smooth surface that could be trimmed
    TrimSurface = "K0876";
    /// an outline leaves the parameters of its surface
    TrimOutside = "K0877";
    /// a shape is no surface over parameters
    NoSurface = "K0878";
    /// surfaces share no side
    ApartSurfaces = "K0879";
    /// lines that bound a curved face come too close to each other
    TangledLines = "K0880";
    /// a formula surface does not close where it is said to
    FormulaGap = "K0890";
    /// a surface has only one side
    OneSided = "K0891";
    /// a surface is thicker than its bends have room for
    TooThick = "K0892";

    /// an expression of solids cannot be read
    SolidSyntax = "K0894";
    /// a shape is not closed where a solid is needed
    NotClosed = "K0895";
    /// a shape is inside out, or encloses no volume
    InsideOut = "K0896";
    /// a shape crosses itself where a solid is needed
    CrossesItself = "K0897";
    /// nothing is left of a solid
    NoSolid = "K0898";
    /// a shape has no flat face in a plane
    NoFaceThere = "K0899";

    /// a limit would be passed
    LimitPassed = "K0901";
    /// the result has nothing to show
    NothingToShow = "K0902";
    /// a map has too few samples
    MapSize = "K0903";
    /// a file holds no map
    MapFile = "K0904";
    /// a picture cannot be a map
    MapImage = "K0905";
    /// a sample of a map has no value
    NoValue = "K0906";
    /// a height map reaches below its base
    BelowBase = "K0907";
    /// scattered points make no map
    MapPoints = "K0908";
    /// masks leave nothing of a height map
    NothingKept = "K0909";
    /// parts of a split body on one plane that cannot be stitched
    SplitParts = "K0910";

    /// this build of Kiln lacks a feature
    MissingFeature = "K0920";

    /// a cage cannot be refined
    BadCage = "K0930";
    /// a cage has no such edge or vertex
    NoCageEdge = "K0931";
    /// a scheme is one of triangles, and a cage has other faces
    NeedsTriangles = "K0932";
    /// a scheme refines borders in every second level
    OddLevels = "K0933";
    /// a field has no surface in its box
    NoFieldSurface = "K0940";
    /// a surface leaves the box in which it is searched
    LeavesBox = "K0941";
    /// a field needs a box
    NeedsBox = "K0942";
    /// an element of a skeleton is nothing, or two things
    NoElement = "K0943";
    /// no sound triangles are found for the surface of a field
    UnsoundSurface = "K0944";
    /// the surface of a field takes too long to find
    TooMuchWork = "K0945";

    /// an assertion does not hold
    AssertionFailed = "K0951";
    /// the report has no such path
    UnknownFact = "K0952";

    /// a skeleton has several roots
    TwoRoots = "K0960";
    /// a bone has no length
    NoBone = "K0961";
    /// a skinned shape is not where its skeleton is
    SkinPlace = "K0962";
    /// vertices that no joint carries
    Unweighted = "K0963";
    /// a track that moves nothing, or what moves already
    BadTrack = "K0964";
    /// keys out of order
    KeyOrder = "K0965";
    /// a key has the wrong numbers
    KeyValue = "K0966";
    /// a clip has no length
    NoTime = "K0967";
    /// a pose is beyond the limits of a joint
    BeyondLimit = "K0968";
    /// a loop does not end as it begins
    LoopSeam = "K0969";
    /// a motion goes past the end of its curve
    PastTheEnd = "K0970";
    /// a motion is not followed within its tolerance
    LooseMotion = "K0971";
    /// a joint does not reach its target
    Unreached = "K0972";

    /// a patch has no area, crosses itself, or is not flat
    BadPatch = "K0973";
    /// a patch does not look away from its center
    PatchSight = "K0974";
    /// a bump of a patch is no quadric
    PatchBump = "K0975";
    /// patches meet in a side as no skin does
    PatchSide = "K0976";
    /// a bump parts neighboring patches
    PatchesPart = "K0977";
    /// the surface of a patch goes too far
    PatchReach = "K0978";
    /// the surface of a patch overhangs, and no solid is known
    PatchOverhang = "K0979";

    /// heights along normals run through each other
    DeepHeights = "K0980";
    /// a base that cannot carry heights
    BadBase = "K0981";
    /// samples of a row that is one point differ
    UnequalPole = "K0982";
    /// heights differ on both sides of a seam, or jump
    TornHeights = "K0983";
    /// a normal map cannot be drawn
    NormalMap = "K0984";
    /// levels of detail that are left out
    FewerLevels = "K0985";
    /// tolerances of levels of detail that do not increase
    BadLevels = "K0986";
    /// a model is too large for a grid of 16 bits
    CoarseGrid = "K0987";
    /// a variant and a profile would be one file
    SameFile = "K0988";

    /// a state of a shape has another topology
    MorphTopology = "K0989";
    /// a shape that cannot morph so
    BadMorph = "K0990";
    /// weights of one mesh that step and run at once
    MixedWeights = "K0991";

    /// a part of a skin by heat that sees no bone
    UnseenBones = "K0992";
    /// a motion of a file that stretches joints unevenly
    StretchedMotion = "K0993";

    /// a collider that belongs to no node
    ColliderPlace = "K0994";
    /// a collider without volume
    FlatCollider = "K0995";

    /// what an engine does not draw of a material
    EngineMaterials = "K1016";

    /// a root of a project has no document
    EmptyRoot = "K1030";
    /// roots of a project overlap
    OverlappingRoots = "K1031";
    /// two documents would be written to one file
    SameOutput = "K1032";
    /// no document has a parameter of the project
    ProjectParameter = "K1033";

    /// levels of detail that an engine does not read
    EngineLevels = "K1050";
    /// colliders that an engine does not read
    EngineColliders = "K1051";
    /// a name that an engine acts upon
    EngineName = "K1052";

    /// a collider of parts for a shape that is no solid
    NoParts = "K1053";
    /// parts of a collider that are less convex than was asked for
    RoughParts = "K1054";

    /// a shape that cannot be laid out on a lightmap
    NoLightmap = "K1055";

    /// a file scaled along one axis more than along another
    UnevenScale = "K1056";
    /// a name that no attribute of vertices can have
    AttributeName = "K1057";
    /// an attribute of vertices that is in no file
    UnseenAttribute = "K1058";
    /// attributes of vertices that an engine does not read
    EngineAttributes = "K1059";

    /// nodes whose aims depend on each other
    AimCircle = "K1070";
    /// a node is where it looks
    AimAtItself = "K1071";

    /// an engine that reads no properties in change
    EngineProperties = "K1072";
    /// something has no property that changes
    NoProperty = "K1073";
    /// a property leaves what it may be
    PropertyRange = "K1074";
    /// a material changes that nothing shows
    UnseenChange = "K1075";
}

impl serde::Serialize for Code {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.text())
    }
}

impl<'de> serde::Deserialize<'de> for Code {
    fn deserialize<D: serde::Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let text = String::deserialize(deserializer)?;
        Self::parse(&text).ok_or_else(|| serde::de::Error::custom("no such code"))
    }
}

impl std::fmt::Display for Code {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        formatter.write_str(self.text())
    }
}
