//! `kiln lsp`: a language server for editors, over standard input and output.
//!
//! Promise: diagnostics as the document is typed (what shows before surfaces are cut), and all of them when it is opened and
//! saved; completion of keys, kinds, words and names; what the reference says of a key, with measured facts of curves and
//! shapes; definitions, references and new names, also in included documents; formatting, changes that mend, an outline,
//! colors. Open documents count as they are shown, not as they are on disk. What is asked of a document that is wrong is
//! answered as far as its words go. Not promised: new names in documents that include this one.
//!
//! Source: Language Server Protocol, version 3.17.

mod answers;
mod desk;
mod guide;
mod names;
mod scan;
mod text;

use std::collections::{BTreeMap, BTreeSet};

use lsp_server::{Connection, ErrorCode, Message, Notification, ProtocolError, Request, Response};
use serde_json::{Value as Json, json};

use super::Outcome;
use super::output::Printer;
use answers::Refusal;
use desk::{Desk, shown};
use text::{Encoding, file_of};

/// Serves one editor until it ends.
pub(crate) fn run(printer: &Printer) -> Outcome {
    let (connection, threads) = Connection::stdio();
    let served = serve(&connection);
    drop(connection);
    let ended = threads.join();
    match served.map_err(|error| error.to_string()).and_then(|()| ended.map_err(|error| error.to_string())) {
        Ok(()) => Outcome::Good,
        Err(reason) => {
            printer.failure(&format!("the editor's end of the line: {reason}"), None);
            Outcome::Files
        }
    }
}

fn serve(connection: &Connection) -> Result<(), ProtocolError> {
    let (id, params) = connection.initialize_start()?;
    let offered = params["capabilities"]["general"]["positionEncodings"].as_array();
    let utf8 = offered.is_some_and(|all| all.iter().any(|one| one == "utf-8"));
    let encoding = if utf8 { Encoding::Utf8 } else { Encoding::Utf16 };
    connection.initialize_finish(id, capabilities(encoding))?;
    let folder = params["workspaceFolders"][0]["uri"].as_str().or_else(|| params["rootUri"].as_str());
    let mut server = Server {
        connection,
        desk: Desk::new(folder.and_then(file_of), encoding),
        changed: BTreeMap::new(),
        told: BTreeMap::new(),
    };
    while let Ok(message) = connection.receiver.recv() {
        if server.take(message)? {
            return Ok(());
        }
        // Letters that were typed meanwhile are looked at together.
        while let Ok(message) = connection.receiver.try_recv() {
            if server.take(message)? {
                return Ok(());
            }
        }
        server.look();
    }
    Ok(())
}

fn capabilities(encoding: Encoding) -> Json {
    json!({
        "capabilities": {
            "positionEncoding": match encoding { Encoding::Utf8 => "utf-8", Encoding::Utf16 => "utf-16" },
            "textDocumentSync": { "openClose": true, "change": 1, "save": true },
            "completionProvider": { "triggerCharacters": [".", "[", "\"", "{"] },
            "hoverProvider": true,
            "definitionProvider": true,
            "referencesProvider": true,
            "renameProvider": { "prepareProvider": true },
            "documentFormattingProvider": true,
            "documentSymbolProvider": true,
            "codeActionProvider": { "codeActionKinds": ["quickfix"] },
            "colorProvider": true,
        },
        "serverInfo": { "name": "kiln", "version": env!("CARGO_PKG_VERSION") },
    })
}

struct Server<'a> {
    connection: &'a Connection,
    desk: Desk,
    /// Documents to be looked at, and whether to the end.
    changed: BTreeMap<String, bool>,
    /// For each document the files that its diagnostics were shown in.
    told: BTreeMap<String, BTreeSet<String>>,
}

impl Server<'_> {
    /// Takes one message; whether it was the last.
    fn take(&mut self, message: Message) -> Result<bool, ProtocolError> {
        match message {
            Message::Request(request) => {
                if self.connection.handle_shutdown(&request)? {
                    return Ok(true);
                }
                let response = self.answer(request);
                self.send(Message::Response(response));
            }
            Message::Notification(note) if note.method == "exit" => return Ok(true),
            Message::Notification(note) => self.note(&note),
            Message::Response(_) => {}
        }
        Ok(false)
    }

    /// An editor that is gone takes nothing; the next message that does not come ends the server.
    fn send(&self, message: Message) {
        let _ = self.connection.sender.send(message);
    }

    fn note(&mut self, note: &Notification) {
        let params = &note.params;
        let Some(uri) = params["textDocument"]["uri"].as_str() else { return };
        match note.method.as_str() {
            "textDocument/didOpen" => {
                self.desk.put(uri, params["textDocument"]["text"].as_str().unwrap_or_default().to_owned());
                self.changed.insert(uri.to_owned(), true);
            }
            "textDocument/didChange" => {
                let all = params["contentChanges"].as_array().and_then(|changes| changes.last());
                if let Some(text) = all.and_then(|change| change["text"].as_str()) {
                    self.desk.put(uri, text.to_owned());
                    self.changed.entry(uri.to_owned()).or_insert(false);
                }
            }
            "textDocument/didSave" => {
                // What includes it may be right now, or wrong.
                let all: Vec<String> = self.desk.sheets.keys().cloned().collect();
                self.changed.extend(all.into_iter().map(|uri| (uri, true)));
            }
            "textDocument/didClose" => {
                self.desk.sheets.remove(uri);
                self.changed.remove(uri);
                self.publish(uri, BTreeMap::new());
            }
            _ => {}
        }
    }

    /// Looks at what was changed, and shows what is wrong.
    fn look(&mut self) {
        for (uri, whole) in std::mem::take(&mut self.changed) {
            self.desk.look(&uri, whole);
            let mut files: BTreeMap<String, Vec<Json>> = BTreeMap::from([(uri.clone(), Vec::new())]);
            let found = self.desk.sheets.get(&uri).and_then(|sheet| sheet.found.as_ref());
            for (file, one) in found
                .iter()
                .flat_map(|list| list.iter().filter_map(|one| shown(one, list, (&uri, &self.desk))))
            {
                files.entry(file).or_default().push(one);
            }
            self.publish(&uri, files);
        }
    }

    fn publish(&mut self, uri: &str, files: BTreeMap<String, Vec<Json>>) {
        let before = self.told.insert(uri.to_owned(), files.keys().cloned().collect()).unwrap_or_default();
        let gone = before.into_iter().filter(|file| !files.contains_key(file)).map(|file| (file, Vec::new()));
        let all: Vec<(String, Vec<Json>)> = gone.chain(files.clone()).collect();
        for (file, list) in all {
            let params = json!({ "uri": file, "diagnostics": list });
            self.send(Message::Notification(Notification::new(
                "textDocument/publishDiagnostics".to_owned(),
                params,
            )));
        }
    }

    fn answer(&mut self, request: Request) -> Response {
        let params = &request.params;
        let desk = &mut self.desk;
        let answer = match request.method.as_str() {
            "textDocument/completion" => desk.completion(params),
            "textDocument/hover" => desk.hover(params),
            "textDocument/definition" => desk.definition(params),
            "textDocument/references" => desk.references(params),
            "textDocument/prepareRename" => desk.prepare_rename(params),
            "textDocument/rename" => match desk.rename(params) {
                Ok(edit) => Some(edit),
                Err(Refusal(reason)) => {
                    return Response::new_err(request.id, ErrorCode::RequestFailed as i32, reason);
                }
            },
            "textDocument/formatting" => desk.formatting(params),
            "textDocument/documentSymbol" => desk.symbols(params),
            "textDocument/codeAction" => desk.actions(params),
            "textDocument/documentColor" => desk.colors(params),
            "textDocument/colorPresentation" => Some(Desk::color_text(params)),
            other => {
                let reason = format!("`{other}` is not known");
                return Response::new_err(request.id, ErrorCode::MethodNotFound as i32, reason);
            }
        };
        Response::new_ok(request.id, answer.unwrap_or(Json::Null))
    }
}
