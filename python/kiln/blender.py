"""The operator "Bake with Kiln" of Blender: bakes a spec, and imports what comes of it.

File > Import > Model spec (.toml). Promise: what is wrong with the spec is told as the command tells it, and nothing of
the scene changes then; what was imported from the same spec before is replaced where that is asked for. Not promised:
that changes made to it in Blender survive that.
"""

import shlex
import tempfile
from collections.abc import Iterator
from collections.abc import Set as AbstractSet
from pathlib import Path
from typing import ClassVar

import bpy
from bpy.props import BoolProperty, StringProperty
from bpy_extras.io_utils import ImportHelper

from . import Baked, BakeError, bake

SPEC = "kiln_spec"  # the property of objects that names the spec they were baked from


class BakeWithKiln(bpy.types.Operator, ImportHelper):
    """Bake a model spec with Kiln, and import it."""

    bl_idname = "import_scene.kiln"
    bl_label = "Bake with Kiln"
    bl_options: ClassVar[set[str]] = {"REGISTER", "UNDO"}

    filename_ext = ".toml"
    filter_glob: StringProperty(default="*.toml", options={"HIDDEN"})  # type: ignore[valid-type]
    parameters: StringProperty(  # type: ignore[valid-type]
        name="Parameters", description="What parameters shall be: height=0.3 lid=true", default=""
    )
    variant: StringProperty(  # type: ignore[valid-type]
        name="Variant", description="The variant to import; empty for the document itself", default=""
    )
    replace: BoolProperty(  # type: ignore[valid-type]
        name="Replace", description="Remove what was imported from the same spec before", default=True
    )
    program: StringProperty(  # type: ignore[valid-type]
        name="Program", description="The program kiln; empty to look for it", default="", subtype="FILE_PATH"
    )

    def execute(self, context: bpy.types.Context) -> AbstractSet[str]:
        """Bakes and imports."""
        spec = Path(self.filepath).resolve()
        with tempfile.TemporaryDirectory() as folder:
            try:
                baked = self.baked(spec, Path(folder))
            except (BakeError, OSError, ValueError) as error:
                self.report({"ERROR"}, str(error))
                return {"CANCELLED"}
            wanted = [asset for asset in baked if (asset.variant or "") == self.variant]
            if not wanted:
                self.report({"ERROR"}, f"{spec.name} has no variant `{self.variant}`")
                return {"CANCELLED"}
            if self.replace:
                remove(str(spec))
            before = set(context.scene.objects)
            bpy.ops.import_scene.gltf(filepath=str(wanted[0].path))
        for warning in baked.warnings:
            self.report({"WARNING"}, str(warning))
        for item in set(context.scene.objects) - before:
            item[SPEC] = str(spec)
        return {"FINISHED"}

    def baked(self, spec: Path, out: Path) -> Baked:
        """The assets of the spec, as floats that Blender reads."""
        words = shlex.split(self.parameters)
        wrong = [word for word in words if "=" not in word]
        if wrong:
            message = f"write parameters as height=0.3, not {wrong[0]}"
            raise ValueError(message)
        given = dict(word.split("=", 1) for word in words)
        return bake(
            spec.name, out=out, set=given, profile=["core"], directory=spec.parent, program=self.program or None
        )


def remove(spec: str) -> None:
    """Removes the objects of a spec, and the data of theirs that nothing else uses."""
    objects = [item for item in bpy.data.objects if item.get(SPEC) == spec]
    used = {one for item in objects for one in data_of(item)}
    bpy.data.batch_remove(objects)
    # Pictures are unused only when their materials are gone, and these when the meshes are.
    late = (bpy.types.Material, bpy.types.Image)
    for some in (
        [one for one in used if not isinstance(one, late)],
        [one for one in used if isinstance(one, bpy.types.Material)],
        [one for one in used if isinstance(one, bpy.types.Image)],
    ):
        bpy.data.batch_remove([one for one in some if one.users == 0])


def data_of(item: bpy.types.Object) -> Iterator[bpy.types.ID]:
    """What an object is made of: its data, their materials with their pictures, and the actions that move it."""
    keys = getattr(item.data, "shape_keys", None)
    for animated in (item, keys):
        if animated is not None and animated.animation_data is not None:
            action = animated.animation_data.action
            yield from [action] if action is not None else []
    if item.data is None:
        return
    yield item.data
    for material in filter(None, getattr(item.data, "materials", [])):
        yield material
        nodes = material.node_tree.nodes if material.node_tree else []
        yield from (node.image for node in nodes if getattr(node, "image", None) is not None)


def entry(menu: bpy.types.Menu, _: bpy.types.Context) -> None:
    """The line in the menu of imports."""
    menu.layout.operator(BakeWithKiln.bl_idname, text="Model spec (.toml)")


def register() -> None:
    """Puts the operator into Blender."""
    bpy.utils.register_class(BakeWithKiln)
    bpy.types.TOPBAR_MT_file_import.append(entry)


def unregister() -> None:
    """Takes the operator out of Blender."""
    bpy.types.TOPBAR_MT_file_import.remove(entry)
    bpy.utils.unregister_class(BakeWithKiln)
