//! Skeletons, skins and clips in the file, played again by the report from its bytes.

use kiln::compile::Options;
use kiln::report::{ClipFacts, PoseFacts};
use serde_json::Value;

use super::{Baked, bake, bake_with};

/// A stick of two bones along y, with a skin.
const STICK: &str = "
[shape.stick]
at = [0, 1, 0]
[shape.stick.box]
size = [0.2, 2, 0.2]
[skeleton.arm.joint.upper]
head = [0, 0, 0]
tail = [0, 1, 0]
[skeleton.arm.joint.lower]
parent = \"upper\"
tail = [0, 2, 0]
[skin.stick]
shape = \"stick\"
skeleton = \"arm\"
weights = \"rigid\"
";

fn clip<'a>(baked: &'a Baked, name: &str) -> &'a ClipFacts {
    &baked.report().clips[name]
}

fn at(pose: &PoseFacts, node: &str) -> [f64; 3] {
    let matrix = pose.nodes[node];
    [matrix[12], matrix[13], matrix[14]]
}

fn apart(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

fn count(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap_or_else(|| panic!("{value} is no count"))).expect("small")
}

/// Every vertex of the upper end turns about the elbow on a circle.
#[test]
fn joints_carry_what_is_around_their_bones() {
    let text = format!(
        "{STICK}[[clip.bend.track]]\njoint = \"lower\"\npath = \"rotation\"\naxis = \"x\"\nkeys = [{{ at = 0, value = 0 }}, {{ at = 2, value = 90 }}]"
    );
    let baked = bake(&text);
    let last = clip(&baked, "bend").poses.last().expect("poses");
    assert!(apart(at(last, "lower"), [0.0, 1.0, 0.0]) < 1e-6);
    // The bone that pointed up points to z.
    let [.., y_x, y_y, y_z] = <[f64; 7]>::try_from(&last.nodes["lower"][..7]).expect("seven");
    assert!(apart([y_x, y_y, y_z], [0.0, 0.0, 1.0]) < 1e-6, "{:?}", last.nodes["lower"]);
    let rest = baked.glb.named("stick").positions;
    let mut turned = 0;
    for vertex in &last.vertices["stick"] {
        let [x, y, z] = rest[vertex.vertex];
        let expected = if y > 1.0 { [x, 1.0 - z, y - 1.0] } else { [x, y, z] };
        assert!(apart(vertex.at, expected) < 1e-6, "{:?} from {:?}", vertex.at, rest[vertex.vertex]);
        turned += usize::from(y > 1.0);
    }
    assert!(turned > 2);
    // Two keys are enough: on the sphere exactly, and by a straight line within the tolerance of a quarter turn.
    let facts = clip(&baked, "bend");
    assert!(facts.bound <= facts.tolerance && facts.duration == 2.0, "{facts:?}");
}

#[test]
fn written_weights_sum_to_255_for_every_rule() {
    let ball = "[shape.a]\nsegments = [24, 16]\n[shape.a.sphere]\nradius = 1\n[skeleton.s.chain.spine]\npoints = [[0, -1, 0], [0, -0.4, 0], [0, 0, 0], [0, 0.3, 0], [0, 0.6, 0], [0, 1, 0]]\nradius = 0.3\nfalloff = 1.2\n[skin.k]\nshape = \"a\"\nskeleton = \"s\"\n";
    let explicit = "weights = \"explicit\"\nweight = [{ joint = \"spine-1\", formula = \"= 1 - y\" }, { joint = \"spine-5\", formula = \"= 1 + y\" }]";
    for (rule, most) in [
        ("weights = \"rigid\"", 1),
        ("smoothing = 0", 4),
        ("smoothing = 8", 4),
        ("weights = \"heat\"", 4),
        (explicit, 2),
    ] {
        let baked = bake(&format!("{ball}{rule}"));
        assert_eq!(baked.report().skins["k"].most_influences, most, "{rule}");
        let attributes = &baked.glb.list("meshes")[0]["primitives"][0]["attributes"];
        let weights = baked.glb.accessor(count(&attributes["WEIGHTS_0"]));
        let joints = baked.glb.accessor(count(&attributes["JOINTS_0"]));
        assert!(baked.glb.list("accessors")[count(&attributes["WEIGHTS_0"])]["normalized"] == true);
        for (weights, joints) in weights.iter().zip(&joints) {
            assert_eq!(weights.iter().sum::<f64>(), 255.0, "{rule}: {weights:?}");
            assert!(weights.windows(2).all(|pair| pair[0] >= pair[1]), "{rule}: {weights:?}");
            assert!(
                weights
                    .iter()
                    .zip(joints)
                    .all(|(weight, joint)| *joint < 5.0 && (*weight > 0.0 || *joint == 0.0))
            );
        }
    }
}

/// Vertices that stand on one point have the same joints: a seam never opens.
#[test]
fn points_move_as_one() {
    let baked = bake(
        &format!("{STICK}smoothing = 3\n")
            .replace("\"rigid\"", "\"envelope\"")
            .replace("[skeleton.arm.joint.upper]", "[skeleton.arm.joint.upper]\nradius = 0.3\nfalloff = 1")
            .replace("[skeleton.arm.joint.lower]", "[skeleton.arm.joint.lower]\nradius = 0.3\nfalloff = 1"),
    );
    let attributes = &baked.glb.list("meshes")[0]["primitives"][0]["attributes"];
    let weights = baked.glb.accessor(count(&attributes["WEIGHTS_0"]));
    let positions = baked.glb.named("stick").positions;
    assert_eq!(positions.len(), 24);
    for (a, first) in positions.iter().enumerate() {
        for (b, second) in positions.iter().enumerate() {
            assert!(first != second || weights[a] == weights[b], "{first:?}");
        }
    }
}

#[test]
fn steps_stay_steps_equal_times_are_shared_and_what_rests_is_left_out() {
    let track = |joint: &str, path: &str, rest: &str| {
        format!("[[clip.c.track]]\njoint = \"{joint}\"\npath = \"{path}\"\n{rest}\n")
    };
    let straight = "axis = \"x\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 5 }]";
    let text = [
        STICK.to_owned(),
        "[clip.c]\nduration = 1\nevent = [{ at = 0.5, name = \"tick\" }]\n".to_owned(),
        track("upper", "rotation", straight),
        track("lower", "rotation", straight),
        track("upper", "translation", "between = \"step\"\naxis = \"y\"\nkeys = [{ at = 0, value = 0 }, { at = 0.5, value = 1 }, { at = 0.75, value = 1 }]"),
        track("lower", "scale", "formula = \"= 1 + 0 * t\""),
    ]
    .concat();
    let baked = bake(&text);
    let animation = &baked.glb.list("animations")[0];
    let samplers = animation["samplers"].as_array().expect("samplers");
    assert_eq!(animation["extras"]["events"][0]["name"], "tick");
    assert_eq!((samplers.len(), clip(&baked, "c").tracks), (3, 3));
    let shared = |a: usize, b: usize| samplers[a]["input"] == samplers[b]["input"];
    assert!(shared(0, 1) && !shared(0, 2));
    assert_eq!(samplers[2]["interpolation"], "STEP");
    assert_eq!(baked.glb.accessor(count(&samplers[2]["input"])), [[0.0], [0.5]]);
    assert!(samplers[0].get("interpolation").is_none_or(|way| way == "LINEAR"));
}

/// The same creature in centimetres with z up is the same file.
#[test]
fn units_and_axes_change_nothing() {
    let spec = |unit: f64, up: bool| {
        let point = |x: f64, y: f64, z: f64| {
            let [x, y, z] = if up { [x, -z, y] } else { [x, y, z] }.map(|c| c / unit);
            format!("[{x}, {y}, {z}]")
        };
        let head = if up { "unit = \"cm\"\nup = \"z\"\n" } else { "" };
        format!(
            "{head}[node.n]\nshape = \"b\"\n[shape.b]\nat = {}\n[shape.b.box]\nsize = {}\n[skeleton.s.joint.a]\nhead = {}\ntail = {}\n[skeleton.s.joint.b]\nparent = \"a\"\ntail = {}\n[skeleton.s.socket.tip]\njoint = \"b\"\n[skin.k]\nshape = \"b\"\nskeleton = \"s\"\nweights = \"rigid\"\n[[clip.c.track]]\njoint = \"b\"\npath = \"rotation\"\nkeys = [{{ at = 0, value = [0, 0, 0] }}, {{ at = 1, value = [20, 30, 40] }}]\n[[clip.c.track]]\njoint = \"a\"\npath = \"translation\"\naxis = \"y\"\nkeys = [{{ at = 0, value = 0 }}, {{ at = 1, value = {} }}]\n",
            point(0.0, 0.5, 0.0),
            if up { "[20, 40, 100]" } else { "[0.2, 1, 0.4]" },
            point(0.0, 0.0, 0.0),
            point(0.0, 0.5, 0.1),
            point(0.1, 1.0, 0.0),
            0.3 / unit,
        )
    };
    let (metres, other) = (bake(&spec(1.0, false)), bake(&spec(0.01, true)));
    for (one, two) in clip(&metres, "c").poses.iter().zip(&clip(&other, "c").poses) {
        for (name, matrix) in &one.nodes {
            let off = matrix.iter().zip(&two.nodes[name]).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(off < 1e-6, "{name} at {}: {off}", one.time);
        }
    }
}

/// A circle of radius 2 in the ground, once round in 4 seconds: arc length is angle.
#[test]
fn nodes_move_along_curves_by_length() {
    let text = "[node.car]\nshape = \"b\"\n[shape.b.box]\nsize = [0.2, 0.2, 0.4]\n[curve.ring.nurbs]\ndegree = 2\npoints = [[2, 0, 0], [2, 0, -2], [0, 0, -2], [-2, 0, -2], [-2, 0, 0], [-2, 0, 2], [0, 0, 2], [2, 0, 2], [2, 0, 0]]\nweights = [1, 0.7071067811865476, 1, 0.7071067811865476, 1, 0.7071067811865476, 1, 0.7071067811865476, 1]\nknots = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4]\n[clip.c]\nduration = 4\ntolerance = 0.0005\n[[clip.c.track]]\nnode = \"car\"\nalong = \"ring\"\n";
    let baked = bake(text);
    for pose in &clip(&baked, "c").poses {
        let (sin, cos) = kiln::geometry::number::sin_cos_degrees(90.0 * pose.time);
        let matrix = pose.nodes["car"];
        let tolerance = clip(&baked, "c").tolerance + 1e-6;
        assert!(apart(at(pose, "car"), [2.0 * cos, 0.0, -2.0 * sin]) < tolerance, "{}", pose.time);
        // z looks along, y stays up.
        assert!(
            apart([matrix[8], matrix[9], matrix[10]], [-sin, 0.0, -cos]) < 5e-3,
            "{}: {matrix:?}",
            pose.time
        );
        assert!(apart([matrix[4], matrix[5], matrix[6]], [0.0, 1.0, 0.0]) < 1e-5);
    }
    // From rest to a speed: at half of the time a quarter of the way.
    let keyed = bake(&format!("{text}speed = [{{ at = 0, value = 0 }}, {{ at = 4, value = 6.283 }}]"));
    let half = &clip(&keyed, "c").poses[4];
    let (sin, cos) = kiln::geometry::number::sin_cos_degrees(90.0);
    assert!(apart(at(half, "car"), [2.0 * cos, 0.0, -2.0 * sin]) < 2e-3, "{half:?}");
}

#[test]
fn sides_are_mirrored() {
    let text = "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s]\nmirror = \"x\"\n[skeleton.s.joint.hip]\nhead = [0, 1, 0]\ntail = [0, 1.2, 0]\n[skeleton.s.joint.left-leg]\nparent = \"hip\"\nhead = [0.1, 1, 0]\ntail = [0.3, 0.1, 0.1]\nroll = 20\nlimits = { z = [-10, 40], y = [-5, 15] }\n[skeleton.s.chain.left-toe]\nparent = \"left-leg\"\npoints = [[0.3, 0.1, 0.1], [0.3, 0, 0.2], [0.35, 0, 0.3]]\n[skeleton.s.socket.left-heel]\njoint = \"left-leg\"\nat = [0.01, 0.5, 0.02]\n[[clip.c.track]]\njoint = \"left-leg\"\npath = \"rotation\"\nkeys = [{ at = 0, value = [10, 15, 40] }, { at = 1, value = [10, 15, 40] }]\n[[clip.c.track]]\njoint = \"right-leg\"\npath = \"rotation\"\nkeys = [{ at = 0, value = [10, -15, -40] }, { at = 1, value = [10, -15, -40] }]\n[[clip.c.track]]\njoint = \"left-toe-2\"\npath = \"rotation\"\naxis = \"x\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 30 }]\n[[clip.c.track]]\njoint = \"right-toe-2\"\npath = \"rotation\"\naxis = \"x\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 30 }]\n";
    let baked = bake(text);
    let last = clip(&baked, "c").poses.last().expect("poses");
    for joint in ["leg", "toe-2"] {
        let (left, right) = (last.nodes[&format!("left-{joint}")], last.nodes[&format!("right-{joint}")]);
        // The mirror image of a frame has its x turned round twice: in space and in itself.
        for (index, (l, r)) in left.iter().zip(right).enumerate() {
            let flips = u32::from(index % 4 == 0) + u32::from(index / 4 == 0);
            let expected = if flips == 1 { -l } else { *l };
            assert!((expected - r).abs() < 1e-6, "{joint} {index}: {left:?} {right:?}");
        }
    }
    assert!(baked.report().nodes.iter().any(|node| node.name == "right-heel"));
    let beyond = text.replace("[10, -15, -40]", "[10, -15, -41]");
    let found =
        super::compile(&beyond, &Options::default()).expect_err("beyond the mirrored limit").to_string();
    assert!(found.contains("joint `right-leg` turns to -41 degrees about its z axis"), "{found}");
}

#[test]
fn clamped_poses_end_at_their_limits() {
    let text = format!(
        "{}[clip.c]\nlimits = \"clamp\"\n[[clip.c.track]]\njoint = \"lower\"\npath = \"rotation\"\naxis = \"x\"\nkeys = [{{ at = 0, value = 0 }}, {{ at = 1, value = 90 }}]",
        STICK.replace("tail = [0, 2, 0]", "tail = [0, 2, 0]\nlimits = { x = [0, 30] }")
    );
    let last = clip(&bake(&text), "c").poses.last().expect("poses").nodes["lower"];
    let (sin, cos) = kiln::geometry::number::sin_cos_degrees(30.0);
    assert!(apart([last[4], last[5], last[6]], [0.0, cos, sin]) < 1e-6, "{last:?}");
}

#[test]
fn the_box_in_the_extras_covers_the_motion_and_sockets_are_marked() {
    let text = format!(
        "{STICK}[skeleton.arm.socket.hand]\njoint = \"lower\"\n[node.stick]\nshape = \"stick\"\n[node.cup]\nshape = \"cup\"\nsocket = \"hand\"\n[shape.cup.cylinder]\nradius = 0.1\nheight = 0.2\n[clip.c]\nloop = true\nduration = 1\n[[clip.c.track]]\njoint = \"lower\"\npath = \"rotation\"\naxis = \"z\"\nformula = \"= 70 * sin(360 * t)\"\n[[clip.c.track]]\njoint = \"upper\"\npath = \"rotation\"\naxis = \"x\"\nformula = \"= 40 * sin(720 * t)\""
    );
    let baked = bake(&text);
    let extras = &baked.glb.list("animations")[0]["extras"];
    assert_eq!(extras["loop"], true);
    let (bounds, found) = (&extras["bounds"], clip(&baked, "c").bounds);
    for axis in 0..3 {
        let (min, max) = (
            bounds["min"][axis].as_f64().expect("a number"),
            bounds["max"][axis].as_f64().expect("a number"),
        );
        assert!(min <= found.min[axis] && found.max[axis] <= max, "{axis}: {bounds} {found:?}");
        assert!(max - min < 2.0 * (found.max[axis] - found.min[axis]), "{axis}: far too wide");
    }
    let hand = baked.glb.list("nodes").iter().find(|node| node["name"] == "hand").expect("the socket");
    assert_eq!(hand["extras"]["socket"], true);
    assert_eq!(hand["children"].as_array().map(Vec::len), Some(1));
    let cup = clip(&baked, "c").poses[0].nodes.contains_key("cup");
    assert!(!cup, "what only is carried needs no telling");
}

#[test]
fn motion_is_the_same_for_any_number_of_threads() {
    let fish = include_str!("../../specs/motion/fish.toml");
    let warm = fish.replace("smoothing = 2", "weights = \"heat\"");
    assert_ne!(fish, warm);
    for text in [fish, &warm] {
        let once = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
            pool.install(|| {
                bake_with(text, &Options { name: "fish".to_owned(), ..Options::default() }).compiled.bytes
            })
        };
        assert_eq!(once(1), once(4));
    }
}

/// Legs that nearly touch, each with a bone: by distance each leg would pull at the other, by heat it does not.
#[test]
fn heat_goes_along_the_skin_and_not_through_the_air() {
    let leg = |side: f64| format!("{{ at = [{side}, -0.5, 0], box = {{ size = [0.2, 1.2, 0.2] }} }}");
    let text = format!(
        "[shape.body]\nsegments = [4, 4]\n[shape.body.union]\nof = [{}, {}, {{ at = [0, 0.2, 0], box = {{ size = [0.42, 0.4, 0.2] }} }}]\n\
         [skeleton.s.joint.hips]\nhead = [0, 0.1, 0]\ntail = [0, 0.4, 0]\n\
         [skeleton.s.joint.left]\nparent = \"hips\"\nhead = [-0.11, 0, 0]\ntail = [-0.11, -1.1, 0]\n\
         [skeleton.s.joint.right]\nparent = \"hips\"\nhead = [0.11, 0, 0]\ntail = [0.11, -1.1, 0]\n\
         [skin.k]\nshape = \"body\"\nskeleton = \"s\"\nweights = \"heat\"",
        leg(-0.11),
        leg(0.11)
    );
    let baked = bake(&text);
    let attributes = &baked.glb.list("meshes")[0]["primitives"][0]["attributes"];
    let weights = baked.glb.accessor(count(&attributes["WEIGHTS_0"]));
    let joints = baked.glb.accessor(count(&attributes["JOINTS_0"]));
    let mut soles = 0;
    for ((place, weights), joints) in baked.glb.named("body").positions.iter().zip(&weights).zip(&joints) {
        if place[1] > -1.0 {
            continue;
        }
        let own = if place[0] < 0.0 { 1.0 } else { 2.0 };
        assert!(joints[0] == own && weights[0] >= 250.0, "{joints:?} {weights:?} at {place:?}");
        soles += 1;
    }
    assert!(soles >= 8);
}

/// Half of the tolerance never costs fewer keys, and every bound holds.
#[test]
fn tolerance_buys_keys() {
    let spec = |tolerance: f64| {
        let text = include_str!("../../specs/motion/fish.toml");
        text.replace("motion-tolerance = 0.001", &format!("motion-tolerance = {tolerance}"))
    };
    let mut before = 0;
    for tolerance in [0.01, 0.003, 0.001, 0.0003] {
        let baked = bake(&spec(tolerance));
        let facts = clip(&baked, "swim");
        assert!(facts.bound <= tolerance && facts.tolerance == tolerance, "{facts:?}");
        assert!(facts.keys > before, "{tolerance}: {} keys after {before}", facts.keys);
        before = facts.keys;
    }
}

/// A chain with limits whose tip follows a circle: in the file it is there in every frame, and within its limits.
#[test]
fn tips_follow_their_targets_in_the_file() {
    let text = "[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.chain.arm]\npoints = [[0, 0, 0], [0, 0.5, 0], [0, 1, 0], [0, 1.4, 0]]\nlimits = { x = [-100, 100], y = [-30, 30], z = [-80, 80] }\n[clip.c]\nloop = true\ntolerance = 1e-4\nduration = 2\n[[clip.c.reach]]\njoint = \"arm-3\"\nreach = \"required\"\nformula = [\"= 0.6 * cos(180 * t)\", \"= 0.8 + 0.2 * sin(360 * t)\", \"= 0.6 * sin(180 * t)\"]\n";
    let baked = bake(text);
    let facts = clip(&baked, "c");
    let tip = &facts.reaches["arm-3"];
    assert_eq!((tip.frames.len(), tip.reached), (121, 121));
    assert!(tip.worst < 2e-4, "{}", tip.worst);
    for frame in &tip.frames {
        let (sin, cos) = kiln::geometry::number::sin_cos_degrees(180.0 * frame.time);
        assert!(apart(frame.target, [0.6 * cos, 0.8 + 0.4 * sin * cos, 0.6 * sin]) < 1e-6);
    }
    // The other tool chain: the written keys, taken apart here.
    let animation = &baked.glb.list("animations")[0];
    for (channel, sampler) in animation["channels"]
        .as_array()
        .expect("channels")
        .iter()
        .zip(animation["samplers"].as_array().expect("samplers"))
    {
        assert_eq!(channel["target"]["path"], "rotation");
        let rest = baked.glb.list("nodes")[count(&channel["target"]["node"])].get("rotation").cloned();
        let rest = rest
            .map_or([0.0, 0.0, 0.0, 1.0], |rest| [0, 1, 2, 3].map(|k| rest[k].as_f64().expect("a number")));
        for key in baked.glb.accessor(count(&sampler["output"])) {
            // Bones along y have no rotation at rest, so a key is the joint's own rotation.
            assert!(rest[3] > 0.999_999, "{rest:?}");
            let [x, y, z, w] = <[f64; 4]>::try_from(key).expect("four");
            let sine = (2.0 * (z * w - x * y)).clamp(-1.0, 1.0);
            let flat = (1.0 - sine * sine).sqrt();
            let twist = (2.0 * (x * z + y * w) / flat).clamp(-1.0, 1.0);
            assert!(sine.abs() < 0.984_82 && twist.abs() < 0.500_01, "beyond the limits: {sine} {twist}");
        }
    }
}

/// The root is carried by a node that moves: targets stand still in the scene all the same.
#[test]
fn targets_are_in_the_scene() {
    let text = "[shape.b.box]\nsize = [1, 1, 1]\n[node.cart]\nrotate = [0, 30, 0]\n[node.b]\nshape = \"b\"\n[skeleton.s]\nparent = \"cart\"\n[skeleton.s.chain.arm]\npoints = [[0, 0, 0], [0, 1, 0], [0, 2, 0]]\n[[clip.c.track]]\nnode = \"cart\"\npath = \"translation\"\naxis = \"x\"\nkeys = [{ at = 0, value = 0 }, { at = 1, value = 1 }]\n[[clip.c.reach]]\njoint = \"arm-2\"\ntarget = [0.5, 1.2, 0.3]\nreach = \"required\"\n";
    let baked = bake(text);
    let tip = &clip(&baked, "c").reaches["arm-2"];
    assert!(tip.reached == 61 && tip.frames.len() == 61 && tip.worst < 1e-3, "{tip:?}");
    assert!(tip.frames.iter().all(|frame| apart(frame.target, [0.5, 1.2, 0.3]) < 1e-12));
}

/// A leg whose knee bends toward its pole, in centimetres with z up.
#[test]
fn poles_and_units() {
    let text = "unit = \"cm\"\nup = \"z\"\n[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.chain.leg]\npoints = [[0, 0, 100], [0, 0, 50], [0, 0, 0]]\n[clip.c]\nduration = 1\n[[clip.c.reach]]\njoint = \"leg-2\"\npole = [0, -100, 50]\nformula = [0, 0, \"= 30 + 10 * t\"]\nreach = \"required\"\n";
    let baked = bake(text);
    let facts = clip(&baked, "c");
    assert!(facts.reaches["leg-2"].worst < 2e-4);
    for pose in &facts.poses {
        // Before the document's -y is the file's +z.
        let knee = at(pose, "leg-2");
        let ankle = 0.3 + 0.1 * pose.time;
        let half = (1.0 - ankle) / 2.0;
        let aside = (0.25 - half * half).sqrt();
        assert!(apart(knee, [0.0, 1.0 - half, aside]) < 0.01, "{}: {knee:?}", pose.time);
    }
}

/// A file's joints and motion: the arm, which points to x, rises by its rotation about z; the root goes up.
#[test]
fn motions_of_files_are_played() {
    let motion = "HIERARCHY\nROOT Hips\n{\nOFFSET 0 1 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\nJOINT LeftArm\n{\nOFFSET 0 0.5 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0.4 0 0\n}\n}\n}\nMOTION\nFrames: 2\nFrame Time: 1\n0 0 0 0 0 0 0 0 0\n0 0.1 0 0 0 0 30 0 0\n";
    let text = "unit = \"cm\"\nup = \"z\"\n[shape.b.box]\nsize = [1, 1, 1]\n[skeleton.s.import]\nfile = \"wave.bvh\"\nscale = 100\n[skeleton.s.socket.hand]\njoint = \"left-arm\"\n[clip.wave.import]\nfile = \"wave.bvh\"\n";
    let files = super::inputs().with("spec.toml", text).with("wave.bvh", motion);
    let document = kiln::language::Document::load("spec.toml", &files).expect("it is read");
    let compiled =
        kiln::compile(&document, &files, &Options::default()).unwrap_or_else(|found| panic!("{found}"));
    let facts = &compiled.report.expect("a report").clips["wave"];
    let last = facts.poses.last().expect("poses");
    assert!(apart(at(last, "hips"), [0.0, 1.1, 0.0]) < 1e-6 && facts.duration == 1.0, "{last:?}");
    let arm = last.nodes["left-arm"];
    let (sin, cos) = kiln::geometry::number::sin_cos_degrees(30.0);
    assert!(apart([arm[4], arm[5], arm[6]], [cos, sin, 0.0]) < 1e-6, "{arm:?}");
    assert!(apart(at(last, "left-arm"), [0.0, 1.6, 0.0]) < 1e-6, "{arm:?}");
}
