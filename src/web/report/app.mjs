// Report: a table of files with their curves, and views of the files that travel in the page.
import { decoderOf, heldFiles } from "../viewer/held.mjs";
import { short } from "../viewer/facts.mjs";
import { Viewer } from "../viewer/viewer.mjs";
import { cellText } from "./cells.mjs";
import { Curves } from "./curves.mjs";
import { Table } from "./table.mjs";
import { Thumbnails } from "./thumbnails.mjs";

const find = (selector) => document.querySelector(selector);

/** Start the page; the arguments are those of the page that shows meshes alone. */
export async function start({ core, program }) {
  const decode = await decoderOf(core, program);
  const viewer = new Viewer(decode);
  const { report } = JSON.parse(find("#facts").textContent);
  Object.assign(globalThis, { deltameshViewer: viewer, deltameshReport: new Report(viewer, report) });
  document.body.dataset.state = "ready";
}

/** A report, and the way from it to views of its files and back. */
class Report {
  constructor(viewer, { title, summary, notes, columns, rows, curves }) {
    this.viewer = viewer;
    this.columns = columns;
    this.rows = rows;
    this.files = heldFiles();
    find("#report h1").textContent = title;
    find("#summary").append(summaryOf(summary));
    find("#notes").append(...notes.map((text) => Object.assign(document.createElement("p"), { textContent: text })));
    const open = (row) => this.open(row);
    this.thumbnails = new Thumbnails(viewer.decode, this.files);
    this.table = new Table({ columns, rows, thumbnails: this.thumbnails, open });
    if (curves) this.curves = new Curves({ columns, rows, open, ...curves });
    this.#listen();
    this.show();
  }

  /** Show the report. */
  show() {
    document.body.classList.add("reporting");
    find("#report").focus();
  }

  /** Show the views. */
  hide() {
    document.body.classList.remove("reporting");
    this.viewer.draw();
  }

  /** Open the files of a row, in views beside each other. */
  async open(row) {
    const files = row.files.map((i) => this.files[i]);
    if (!files.length) return;
    this.hide();
    this.viewer.closeAll();
    this.viewer.controls.setCompared([this.#numbersOf(row)]);
    await this.viewer.openAll(files);
  }

  /** Return the numbers of a row and of the rows beside which it is seen. */
  #numbersOf(row) {
    const others = [row, ...(row.beside ?? []).map((i) => this.rows[i])];
    return this.columns
      .map(({ title, kind }, k) => [title, ...others.map(({ cells }) => cellText(cells[k], kind))])
      .filter(([, ...values]) => values.some(Boolean));
  }

  #listen() {
    const back = document.createElement("button");
    Object.assign(back, { id: "back", textContent: "← Report", title: "Back to the report (Escape)" });
    back.addEventListener("click", () => this.show());
    find("header").prepend(back);
    addEventListener("keydown", ({ key }) => {
      if (key === "Escape" && !find("#keys").open) this.show();
    });
    addEventListener("drop", () => this.hide());
  }
}

/** Return a table whose first row is a head. */
function summaryOf(rows) {
  const table = document.createElement("table");
  rows.forEach((cells, i) => {
    const row = table.insertRow();
    cells.forEach((cell, k) => {
      const own = document.createElement(i && k ? "td" : "th");
      own.textContent = typeof cell === "number" ? short(cell) : cell;
      row.append(own);
    });
  });
  return table;
}

