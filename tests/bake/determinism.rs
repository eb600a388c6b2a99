//! The same text gives the same bytes on any number of threads.

use kiln::compile::Options;

use super::compile;

/// Many shapes of all kinds, with textures, tangents, instances and imports.
fn document() -> String {
    let mut text = String::from(
        "tolerance = 0.006\n[material.x]\ncolor-texture = \"label.png\"\nnormal-texture = \"bumps.png\"\n[material.y]\ncolor = \"#123456\"\n\
         [shape.bird]\nmaterial = \"x\"\nuv = \"always\"\n[shape.bird.import]\nfile = \"bird.obj\"\n",
    );
    for k in 1..=4 {
        text.push_str(&format!(
            "[shape.ball{k}]\nmaterial = \"x\"\n[shape.ball{k}.sphere]\nradius = 0.{k}\n\
             [shape.coil{k}]\nmaterial = \"y\"\n[shape.coil{k}.sweep]\nprofile = {{ circle = {{ radius = 0.0{k} }} }}\n\
             path = {{ helix = {{ radius = 0.5, pitch = 0.2, turns = {k} }} }}\n\
             [shape.both{k}.group]\nof = [\"ball{k}\", {{ array = {{ of = \"coil{k}\", count = 3, offset = [1, 0, 0] }} }}]\n"
        ));
    }
    text
}

#[test]
fn any_number_of_threads_gives_the_same_bytes_and_report() {
    let text = document();
    let options = Options { name: "all".to_owned(), measure: true, ..Options::default() };
    let bake = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        let compiled = pool.install(|| compile(&text, &options)).unwrap_or_else(|found| panic!("{found}"));
        let report = serde_json::to_string(&compiled.report).expect("a report is JSON");
        (compiled.bytes, report, compiled.warnings.render(false))
    };
    let one = bake(1);
    assert!(one.0.len() > 200_000, "only {} bytes: too little to differ", one.0.len());
    for threads in [2, 8] {
        let other = bake(threads);
        assert_eq!(blake3::hash(&other.0), blake3::hash(&one.0), "{threads} threads");
        assert_eq!((other.1, other.2), (one.1.clone(), one.2.clone()), "{threads} threads");
    }
}

#[test]
fn any_number_of_threads_gives_the_same_errors() {
    let mut text = String::from("[limits]\ntriangles = 5000\n");
    for k in 0..12 {
        let tolerance = [0.1, 1e-9, 0.01][k % 3];
        text.push_str(&format!(
            "[shape.s{k}]\ntolerance = {tolerance}\n[shape.s{k}.sphere]\nradius = {}\n",
            k + 1
        ));
    }
    let refuse = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        pool.install(|| compile(&text, &Options::default())).expect_err("it is refused").render(false)
    };
    let one = refuse(1);
    assert!(one.contains("K0901"), "{one}");
    for threads in [2, 8, 8, 8] {
        assert_eq!(refuse(threads), one);
    }
}
