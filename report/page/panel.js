// A panel: a heading, what it shows, its choices, a picture or a table, and below it what one can take away.

/** An element: text content, never markup. make('a', {href: '#x'}, 'text', child) */
export function make(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith('on') || name === 'value' || name === 'checked') element[name] = value;
    else if (value !== false && value !== null) element.setAttribute(name, value === true ? '' : value);
  }
  element.append(...children.filter((child) => child !== null));
  return element;
}

/** A choice with its label; options are [value, text]. */
export class Choice {
  constructor(label, changed) {
    this.select = make('select', {onchange: changed});
    this.element = make('label', {}, label, this.select);
  }
  get value() { return this.select.value; }
  set value(wanted) { this.select.value = wanted; }
  /** New options; what was chosen stays if it is still there, else `preferred` or the first. */
  offer(options, preferred) {
    const before = this.select.value;
    this.select.replaceChildren(...options.map(([value, text]) => make('option', {value}, text)));
    const wanted = [before, preferred].find((v) => options.some(([value]) => value === v));
    if (wanted !== undefined) this.select.value = wanted;
    this.element.hidden = options.length < 1;
  }
}

function download(name, text) {
  const url = URL.createObjectURL(new Blob([text], {type: 'text/csv'}));
  make('a', {href: url, download: name}).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

export class Panel {
  constructor(view, records) {
    this.view = view;
    this.records = records;
    this.curves = [];
    this.controls = make('div', {class: 'controls'});
    this.plot = make('div', {class: view.space ? 'plot space' : 'plot', tabindex: '0', role: 'application',
      'aria-label': `${view.title}: ${view.space ? 'the arrow keys turn the picture' : 'the arrow keys move from point to point'}`});
    this.legend = make('div', {class: 'legend'});
    this.table = make('div', {class: 'wide'});
    this.remark = make('p', {class: 'remark', hidden: true});
    this.output = make('div', {class: 'readout', role: 'status', 'aria-live': 'polite'});
    this.command = make('code', {});
    this.csv = () => '';
    const csv = make('button', {type: 'button', onclick: () => download(`polhode-${view.id}.csv`, this.csv())}, 'CSV');
    this.element = make('section', {id: view.id, class: 'panel'}, make('h3', {}, view.title), make('p', {}, view.about),
      this.controls, ...(view.tabular ? [] : [this.plot, this.legend]), this.table, this.remark, this.output,
      make('p', {class: 'take'}, csv, make('span', {}, 'Again: ', this.command)));
    this.hint();
  }

  choice(label) {
    const choice = new Choice(label, () => this.redraw());
    this.controls.append(choice.element);
    return choice;
  }
  tick(label, checked) {
    const box = make('input', {type: 'checkbox', checked, onchange: () => this.redraw()});
    this.controls.append(make('label', {class: 'tick'}, box, label));
    return box;
  }

  redraw() {
    this.note('');
    this.hint();
    this.view.draw(this, this.context);
  }
  /** What stands where one reads a point before any was pointed at. */
  hint() {
    const usual = 'Point at a curve, or use the arrow keys in the picture: the record is read out here.';
    this.output.textContent = this.view.hint ?? (this.view.tabular ? '' : usual);
  }
  note(text) {
    this.remark.textContent = text;
    this.remark.hidden = !text;
  }
  /** Says so where a choice leaves nothing to show. */
  empty(is) {
    if (is) this.note('Nothing of what is chosen can be shown here.');
    this.plot.hidden = this.legend.hidden = is;
  }
  /** A run's record, or the text alone. */
  readout(run, text) {
    const {records} = this;
    const list = make('dl', {});
    if (text) list.append(make('div', {class: 'now'}, text.replaceAll('\n', ' · ')));
    if (run !== undefined && run !== null) {
      for (const [name, value] of records.facts(run)) list.append(make('div', {}, make('dt', {}, name), make('dd', {}, value)));
      list.append(make('div', {class: 'now'}, make('code', {}, records.command(run))));
    }
    this.output.replaceChildren(list);
  }
  /** The command that makes again what is shown: of one instance, of a problem, or of all. */
  again(filter) {
    const part = filter ? ` --filter '${filter.replaceAll("'", "'\\''")}'` : '';
    this.command.textContent = `polhode run DIR/suite.toml${part} --out NEW && polhode report NEW`;
  }

  /** A table: columns are [title, isNumber]; entries are texts, elements or {text, class, read: [run, text]}. */
  tabulate(columns, rows) {
    const entry = (value, k) => {
      const kind = columns[k][1] ? 'number' : typeof value === 'string' && value.length > 36 ? 'long' : 'short';
      if (!(value !== null && typeof value === 'object' && !(value instanceof Node))) return make('td', {class: kind}, value ?? '–');
      if (value instanceof Node) return make('td', {class: kind}, value);
      const read = () => this.readout(...value.read);
      return make('td', {class: `${kind} ${value.class || ''}`}, value.read ?
        make('button', {type: 'button', class: 'cell', onfocus: read, onpointerenter: read, onclick: read}, ...[value.text].flat()) :
        make('span', {}, ...[value.text].flat()));
    };
    const head = make('tr', {}, ...columns.map(([title, isNumber]) => make('th', {scope: 'col', class: isNumber ? 'number' : 'short'}, title)));
    const body = rows.map((row) => make('tr', {}, ...row.map((value, k) => (k === 0 ?
      make('th', {scope: 'row', class: 'short'}, value) : entry(value, k)))));
    this.table.replaceChildren(make('table', {}, make('thead', {}, head), make('tbody', {}, ...body)));
    if (rows.length === 0) {
      this.table.replaceChildren();
      this.note('Nothing of what is chosen can be shown here.');
    }
  }
}
