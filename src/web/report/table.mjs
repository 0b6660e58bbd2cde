// Table of a report: sorted by a column, filtered by words, some hundred rows at a time.
import { cellText } from "./cells.mjs";

const AT_A_TIME = 200;
const find = (selector) => document.querySelector(selector);

/** Table of rows; `open(row)` is called for a row whose files are to be seen. */
export class Table {
  constructor({ columns, rows, thumbnails, open }) {
    Object.assign(this, { columns, rows, thumbnails, open });
    this.texts = rows.map(({ cells, words = "" }) => [...cells.filter((x) => typeof x === "string"), words].join(" ").toLowerCase());
    this.sorting = { column: -1, falling: false };
    this.shown = AT_A_TIME;
    this.#fillHead();
    find("#filter input").addEventListener("input", () => this.#fillAnew());
    find("#more").addEventListener("click", () => {
      this.shown += AT_A_TIME;
      this.fill();
    });
    this.fill();
  }

  #fillHead() {
    const row = find("#rows thead").insertRow();
    row.append(document.createElement("th"));
    this.heads = this.columns.map(({ title, kind }, column) => {
      const head = document.createElement("th");
      head.scope = "col";
      head.className = kind === "text" ? "" : "number";
      const button = Object.assign(document.createElement("button"), { textContent: title });
      button.addEventListener("click", () => this.sortBy(column));
      head.append(button);
      row.append(head);
      return head;
    });
  }

  /** Sort by a column; by the same one again, the other way round. */
  sortBy(column) {
    const { column: before, falling } = this.sorting;
    this.sorting = { column, falling: column === before && !falling };
    this.#fillAnew();
  }

  #fillAnew() {
    this.shown = AT_A_TIME;
    this.fill();
  }

  /** Return the numbers of the rows that have all words of the filter, in order. */
  chosen() {
    const words = find("#filter input").value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = this.rows.map((_, i) => i).filter((i) => words.every((word) => this.texts[i].includes(word)));
    const { column, falling } = this.sorting;
    if (column < 0) return found;
    const value = (i) => this.rows[i].cells[column];
    const order = (a, b) => (typeof a === "string" ? a.localeCompare(b) : a - b);
    return found.sort((i, j) => {
      // What is not known comes last in either order.
      const [a, b] = [value(i), value(j)];
      if (a === null || b === null) return (a === null) - (b === null) || i - j;
      return (falling ? order(b, a) : order(a, b)) || i - j;
    });
  }

  /** Fill the table anew. */
  fill() {
    const { column, falling } = this.sorting;
    this.heads.forEach((head, k) => (head.ariaSort = k === column ? (falling ? "descending" : "ascending") : "none"));
    const chosen = this.chosen();
    const shown = chosen.slice(0, this.shown);
    this.thumbnails.forgetPlaces();
    find("#rows tbody").replaceChildren(...shown.map((i) => this.#rowOf(this.rows[i])));
    find("#count").textContent = `${chosen.length} of ${this.rows.length} rows`;
    find("#more").hidden = shown.length === chosen.length;
    find("#more").textContent = `${chosen.length - shown.length} more`;
  }

  #rowOf(row) {
    const element = document.createElement("tr");
    if (row.failed) element.className = "failed";
    const look = element.insertCell();
    if (row.thumbnail === null) look.append(Object.assign(document.createElement("span"), { className: "none", textContent: row.without }));
    else look.append(this.#lookAt(row));
    row.cells.forEach((value, k) => {
      const { kind } = this.columns[k];
      const cell = element.insertCell();
      cell.className = kind === "text" ? "" : "number";
      cell.textContent = cellText(value, kind);
    });
    return element;
  }

  #lookAt(row) {
    const button = document.createElement("button");
    button.className = "look";
    button.title = button.ariaLabel = `Look at ${row.cells[0]}`;
    button.addEventListener("click", () => this.open(row));
    this.thumbnails.place(button, row.thumbnail);
    return button;
  }
}
