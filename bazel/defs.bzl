"""Rules of Bazel that bake with Kiln.

    load("@kiln_rules//:defs.bzl", "kiln_asset")

    kiln_asset(
        name = "chest",
        spec = "chest.toml",
        deps = ["materials.toml", "wood.png"],
        kiln = "@kiln//:kiln",
        parameters = {"height": "0.6"},
        variants = ["tall"],
    )

The target's files are the baked `.glb` files; their reports are in the output group `reports`. Promise: an action reads what it
declares and nothing else (`kiln bake --hermetic`: no kiln.toml, no cache, no variable), its command line has no absolute path,
and equal inputs give equal bytes, so that it may run on any machine and be cached for all. A file that a spec reads and `deps`
does not name is an error of the spec, with its place.
"""

def _names(stem, ctx):
    """The files that a document becomes, without their endings: as Kiln names them."""
    names = []
    for variant in [""] + ["." + variant for variant in ctx.attr.variants]:
        for profile in ctx.attr.profiles:
            names.append(stem + variant + ("" if profile == "core" else "." + profile))
    return names + ctx.attr.more

def _kiln_asset_impl(ctx):
    spec = ctx.file.spec
    stem = spec.basename[:-len(".toml")]

    # Outputs stand where the spec does below the package of the target.
    inside = ctx.label.package + "/" if ctx.label.package else ""
    folder = spec.short_path[len(inside):] if spec.short_path.startswith(inside) else spec.basename
    folder = folder[:-len(spec.basename)]
    models = []
    reports = []
    for name in _names(stem, ctx):
        models.append(ctx.actions.declare_file(folder + name + ".glb"))
        if ctx.attr.reports:
            reports.append(ctx.actions.declare_file(folder + name + ".report.json"))

    arguments = ctx.actions.args()
    arguments.add("bake")
    arguments.add(spec)
    arguments.add("--hermetic")
    arguments.add("--root", ".")
    arguments.add("--out", models[0].dirname)
    arguments.add_all(ctx.attr.profiles, before_each = "--profile")
    for parameter in sorted(ctx.attr.parameters.keys()):
        arguments.add("--set", parameter + "=" + ctx.attr.parameters[parameter])
    if not ctx.attr.reports:
        arguments.add("--no-report")
    arguments.add("--quiet")
    ctx.actions.run(
        executable = ctx.executable.kiln,
        arguments = [arguments],
        inputs = depset([spec] + ctx.files.deps),
        outputs = models + reports,
        mnemonic = "KilnBake",
        progress_message = "Baking " + spec.short_path,
        env = {},
    )
    return [
        DefaultInfo(files = depset(models)),
        OutputGroupInfo(reports = depset(reports)),
    ]

kiln_asset = rule(
    implementation = _kiln_asset_impl,
    doc = "Bakes a model spec into glTF.",
    attrs = {
        "spec": attr.label(
            doc = "The document.",
            mandatory = True,
            allow_single_file = [".toml"],
        ),
        "deps": attr.label_list(
            doc = "All files that the document reads: what it includes, images, imported models.",
            allow_files = True,
        ),
        "kiln": attr.label(
            doc = "The program, built or downloaded.",
            mandatory = True,
            allow_single_file = True,
            executable = True,
            cfg = "exec",
        ),
        "parameters": attr.string_dict(
            doc = "What parameters of the document shall be.",
        ),
        "profiles": attr.string_list(
            doc = "For whom files are, one for each.",
            default = ["core"],
        ),
        "variants": attr.string_list(
            doc = "The variants of the document: each is one more file.",
        ),
        "more": attr.string_list(
            doc = "Further files of the document without their endings, as levels of detail in files of their own are: `chest.lod1`.",
        ),
        "reports": attr.bool(
            doc = "Whether reports are written, and assertions checked.",
            default = True,
        ),
    },
)
