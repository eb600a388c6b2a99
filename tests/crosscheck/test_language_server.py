"""`kiln lsp` as an editor sees it: driven by pygls, a client that shares no code with the server."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

import pytest
from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pygls.lsp.client import LanguageClient

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable
    from pathlib import Path

    from kiln import Kiln

SPEC = """[parameters]
height = 0.4

[curve.rim.circle]
radius = 0.5

[shape.rim]
material = "gold"
[shape.rim.extrude]
profile = "rim"
height = "= height"

[material.gold]
color = "#ffcc00"
metallic = 1
"""


class Editor:
    """One document in one editor."""

    def __init__(self, client: LanguageClient, folder: Path) -> None:
        self.client = client
        self.file = folder / "model.toml"
        self.uri = self.file.as_uri()
        self.text = ""
        self.version = 0
        self.told: asyncio.Queue[types.PublishDiagnosticsParams] = asyncio.Queue()

    async def found(self, uri: str | None = None) -> list[types.Diagnostic]:
        """The diagnostics that are told next."""
        while True:
            params = await asyncio.wait_for(self.told.get(), 60)
            if params.uri == (uri or self.uri):
                return list(params.diagnostics)

    async def open(self, text: str) -> list[types.Diagnostic]:
        """Show the document to the server."""
        self.text = text
        item = types.TextDocumentItem(uri=self.uri, language_id="toml", version=0, text=text)
        self.client.text_document_did_open(types.DidOpenTextDocumentParams(text_document=item))
        return await self.found()

    async def type(self, text: str) -> list[types.Diagnostic]:
        """Change the document, and wait for what is told of it."""
        self.show(text)
        return await self.found()

    def show(self, text: str) -> None:
        """Change the document."""
        self.text = text
        self.version += 1
        self.client.text_document_did_change(
            types.DidChangeTextDocumentParams(
                text_document=types.VersionedTextDocumentIdentifier(uri=self.uri, version=self.version),
                content_changes=[types.TextDocumentContentChangeWholeDocument(text=text)],
            )
        )

    def place(self, mark: str, shift: int = 0) -> dict[str, Any]:
        """Where some words stand."""
        before = self.text[: self.text.index(mark) + shift]
        position = types.Position(line=before.count("\n"), character=len(before) - before.rfind("\n") - 1)
        return {"text_document": types.TextDocumentIdentifier(uri=self.uri), "position": position}

    async def labels(self, mark: str, shift: int = 0) -> list[str]:
        """What completion offers there."""
        answer = await self.client.text_document_completion_async(types.CompletionParams(**self.place(mark, shift)))
        assert isinstance(answer, types.CompletionList)
        return [item.label for item in answer.items]

    def applied(self, edits: list[types.TextEdit]) -> str:
        """The text after edits."""
        lines = self.text.splitlines(keepends=True)
        at = lambda position: sum(map(len, lines[: position.line])) + position.character  # noqa: E731 -- one use
        text = self.text
        for edit in sorted(edits, key=lambda one: at(one.range.start), reverse=True):
            text = text[: at(edit.range.start)] + edit.new_text + text[at(edit.range.end) :]
        return text


def edit(kiln: Kiln, folder: Path, work: Callable[[Editor], Awaitable[None]]) -> None:
    """Runs an editor beside a server of its own."""

    async def session() -> None:
        client = LanguageClient("editor", "1")
        editor = Editor(client, folder)

        @client.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def told(params: types.PublishDiagnosticsParams) -> None:
            editor.told.put_nowait(params)

        await client.start_io(str(kiln.program), "lsp")
        capabilities = types.ClientCapabilities()
        params = types.InitializeParams(capabilities=capabilities, root_uri=folder.as_uri())
        started = await client.initialize_async(params)
        assert started.server_info is not None
        assert started.server_info.name == "kiln"
        client.initialized(types.InitializedParams())
        await work(editor)
        await client.shutdown_async(None)
        client.exit(None)
        await client.stop()

    asyncio.run(asyncio.wait_for(session(), 240))


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path.resolve()


def test_errors_come_and_go_while_typing(kiln: Kiln, folder: Path) -> None:
    async def work(editor: Editor) -> None:
        assert await editor.open(SPEC) == []
        (wrong,) = await editor.type(SPEC.replace("metallic", "metalic"))
        assert (wrong.source, wrong.severity) == ("kiln", types.DiagnosticSeverity.Error)
        assert str(wrong.code).startswith("K")
        assert "metalic" in wrong.message
        where = (wrong.range.start.line, wrong.range.start.character, wrong.range.end.character)
        assert where == (SPEC[: SPEC.index("metallic")].count("\n"), 0, len("metalic"))
        # What would mend it is offered, and does.
        context = types.CodeActionContext(diagnostics=[wrong])
        place = types.TextDocumentIdentifier(uri=editor.uri)
        params = types.CodeActionParams(text_document=place, range=wrong.range, context=context)
        actions = await editor.client.text_document_code_action_async(params)
        assert actions
        (action,) = actions
        assert isinstance(action, types.CodeAction)
        assert action.edit is not None
        assert action.edit.changes is not None
        assert editor.applied(list(action.edit.changes[editor.uri])) == SPEC
        # What is no document of ours is let alone.
        assert await editor.type('[package]\nname = "game"\n[dependencies]\n') == []
        # Half a line is an error, and all else still is understood.
        assert await editor.type(SPEC + "[shape.two.")
        assert "revolve" in await editor.labels("[shape.two.", len("[shape.two."))
        assert await editor.type(SPEC) == []

    edit(kiln, folder, work)


def test_words_and_names_are_offered(kiln: Kiln, folder: Path) -> None:
    async def work(editor: Editor) -> None:
        await editor.open(SPEC)
        assert "shape" in await editor.labels("[shape.rim]", 1)
        keys = await editor.labels("metallic = 1")
        assert "roughness" in keys
        assert "color" not in keys
        assert await editor.labels('"gold"', 1) == ["gold"]
        assert await editor.labels('"rim"', 1) == ["rim"]
        assert await editor.labels("= height", 3) == ["height"]
        await editor.type(SPEC.replace('profile = "rim"', "profile = { circle = { } }"))
        assert {"radius", "center"} <= set(await editor.labels("circle = { ", len("circle = { ")))
        assert {"circle", "polyline"} <= set(await editor.labels("{ circle", 2))

    edit(kiln, folder, work)


def test_hover_tells_what_things_are_and_measure(kiln: Kiln, folder: Path) -> None:
    async def work(editor: Editor) -> None:
        await editor.open(SPEC)

        async def hover(mark: str, shift: int = 1) -> str:
            answer = await editor.client.text_document_hover_async(types.HoverParams(**editor.place(mark, shift)))
            assert answer is not None
            assert isinstance(answer.contents, types.MarkupContent)
            return answer.contents.value

        assert "length 3.14159" in await hover("rim.circle")
        told = await hover("rim.extrude")
        assert "triangles" in told
        # A disk of radius 1/2, 0.4 high, cut from chords: a little less than the closed form.
        volume = float(told.split("volume ")[1])
        assert 0.31 < volume < 0.3142
        assert "metal" in (await hover("metallic")).lower()

    edit(kiln, folder, work)


def test_names_lead_to_definitions_and_are_changed_everywhere(kiln: Kiln, folder: Path) -> None:
    (folder / "metals.toml").write_text('[material.gold]\ncolor = "#ffcc00"\n', encoding="utf-8")
    text = 'include = ["metals.toml"]\n' + SPEC[: SPEC.index("[material")].replace("metallic = 1\n", "")

    async def work(editor: Editor) -> None:
        assert await editor.open(text) == []
        place = editor.place('"gold"', 2)
        there = await editor.client.text_document_definition_async(types.DefinitionParams(**place))
        assert isinstance(there, types.Location)
        assert there.uri == (folder / "metals.toml").as_uri()
        assert (there.range.start.line, there.range.start.character) == (0, len("[material."))
        changed = await editor.client.text_document_rename_async(types.RenameParams(**place, new_name="brass"))
        assert changed is not None
        assert changed.changes is not None
        assert {uri: len(edits) for uri, edits in changed.changes.items()} == {editor.uri: 1, there.uri: 1}
        # A curve and a shape of one name are two things, and parameters stand in expressions.
        for mark, new, count in (("rim.circle", "edge", 2), ("height = 0.4", "tall", 2)):
            place = editor.place(mark, 1)
            changed = await editor.client.text_document_rename_async(types.RenameParams(**place, new_name=new))
            assert changed is not None
            assert changed.changes is not None
            edits = list(changed.changes[editor.uri])
            assert len(edits) == count
            before = editor.text
            assert await editor.type(editor.applied(edits)) == []
            await editor.type(before)
        for new, why in (("Bad Name", "is no name"), ("rim", "already")):
            params = types.RenameParams(**editor.place("rim.circle", 1), new_name=new)
            with pytest.raises(JsonRpcException, match=why):
                await editor.client.text_document_rename_async(params)

    edit(kiln, folder, work)


def test_format_outline_and_colors(kiln: Kiln, folder: Path) -> None:
    async def work(editor: Editor) -> None:
        await editor.open(SPEC.replace("radius = 0.5", "radius   =0.5"))
        place = types.TextDocumentIdentifier(uri=editor.uri)
        options = types.FormattingOptions(tab_size=2, insert_spaces=True)
        edits = await editor.client.text_document_formatting_async(
            types.DocumentFormattingParams(text_document=place, options=options)
        )
        assert edits is not None
        assert editor.applied(list(edits)) == SPEC
        symbols = await editor.client.text_document_document_symbol_async(
            types.DocumentSymbolParams(text_document=place)
        )
        assert symbols is not None
        assert [symbol.name for symbol in symbols] == ["height", "rim", "rim", "gold"]
        colors = await editor.client.text_document_document_color_async(types.DocumentColorParams(text_document=place))
        (color,) = colors
        assert (color.color.red, round(color.color.green, 3), color.color.blue) == (1, 0.8, 0)
        chosen = types.Color(red=0.0, green=0.5, blue=1.0, alpha=1.0)
        params = types.ColorPresentationParams(text_document=place, color=chosen, range=color.range)
        (shown,) = await editor.client.text_document_color_presentation_async(params)
        assert shown.label == '"#0080ff"'

    edit(kiln, folder, work)


def test_letters_that_come_faster_than_answers_are_looked_at_together(kiln: Kiln, folder: Path) -> None:
    """A thousand lines: what was typed meanwhile makes no queue, and the last state is what is told."""
    shapes = "".join(f"[shape.s{k}]\nat = [{k}, 0, 0]\n[shape.s{k}.sphere]\nradius = 0.4\n" for k in range(250))

    async def work(editor: Editor) -> None:
        assert await editor.open(shapes) == []
        for count in range(200):
            editor.show(shapes.replace("radius", "radus", count))
        told = [await editor.found()]
        while len(told[-1]) < 199:
            told.append(await editor.found())
        assert len(told) < 200
        # Each word that is wrong is told once.
        assert await editor.type(shapes) == []

    edit(kiln, folder, work)


def test_what_is_not_understood_is_refused_and_the_rest_goes_on(kiln: Kiln, folder: Path) -> None:
    async def work(editor: Editor) -> None:
        await editor.open(SPEC)
        with pytest.raises(JsonRpcException, match="not known"):
            await editor.client.protocol.send_request_async("textDocument/nothing", {})
        nowhere = types.TextDocumentIdentifier(uri="untitled:none")
        position = types.Position(line=3, character=0)
        params = types.HoverParams(text_document=nowhere, position=position)
        assert await editor.client.text_document_hover_async(params) is None
        for text in ("\ufeff", "[", "[[", 'a = "', "[shape.a.box]\nsize = [1,", "= = =", "\u0000"):
            await editor.type(text)
            await editor.labels("" if not text else text[-1], 1)
        assert await editor.type(SPEC) == []

    edit(kiln, folder, work)
