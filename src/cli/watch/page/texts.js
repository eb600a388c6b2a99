// The texts of the document beside the model, with what is wrong under the lines where it is.

// Lines of a text that are shown.
const MOST = 5000;

function element(tag, text, name) {
  const made = document.createElement(tag);
  made.textContent = text;
  if (name) made.className = name;
  return made;
}

export class Texts {
  constructor(place) {
    this.place = place;
    this.revision = 0;
  }

  // Shows the texts of a bake.
  async read(news) {
    if (news.revision === 0) return;
    this.revision = news.revision;
    const sources = await (await fetch('/sources')).json();
    // A later one is on its way.
    if (this.revision !== news.revision) return;
    const scroll = this.place.scrollTop;
    this.place.replaceChildren(...sources.flatMap(({ file, text }) => this.file(file, text, news.diagnostics)));
    this.place.scrollTop = scroll;
    this.place.querySelector('.error')?.scrollIntoView({ block: 'nearest' });
  }

  file(file, text, diagnostics) {
    const list = document.createElement('ol');
    list.dataset.file = file;
    const own = diagnostics.filter((one) => one.file === file);
    const lines = text.split('\n');
    if (lines.at(-1) === '') lines.pop();
    for (const [index, line] of lines.slice(0, MOST).entries()) {
      const item = element('li', line);
      item.dataset.line = index + 1;
      list.append(item);
      for (const one of own.filter((other) => other.line === index + 1)) {
        const help = one.help.map((help) => `\n${help}`).join('');
        list.append(element('li', `${one.code}: ${one.message}${help}`, one.severity));
      }
    }
    if (lines.length > MOST) list.append(element('li', `${lines.length - MOST} more lines`));
    return [element('h2', file), list];
  }

  // Shows a line.
  mark(file, line) {
    this.unmark();
    const lists = [...this.place.querySelectorAll('ol')];
    const found = lists.find((list) => list.dataset.file === file)?.querySelector(`[data-line="${line}"]`);
    found?.classList.add('mark');
    found?.scrollIntoView({ block: 'center' });
  }

  unmark() {
    this.place.querySelector('.mark')?.classList.remove('mark');
  }
}
