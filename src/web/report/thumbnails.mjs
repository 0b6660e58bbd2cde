// Thumbnails of files that the page holds: decoded and drawn when they come into sight.
import { Camera } from "../viewer/camera.mjs";
import { bytesOf } from "../viewer/held.mjs";
import { Panel } from "../viewer/panel.mjs";
import { Renderer } from "../viewer/renderer.mjs";

const [WIDTH, HEIGHT] = [192, 144];
const LOOK = { flat: false, wire: false, anchors: false, ratio: 1, line: [0, 0, 0] };

/** Thumbnails, each drawn once; `decode` returns a promise of what is in the bytes of a file. */
export class Thumbnails {
  constructor(decode, files) {
    Object.assign(this, { decode, files, drawn: new Map(), waiting: [] });
    try {
      this.renderer = new Renderer(canvasOf());
    } catch {
      // No WebGL2: a text stands where the picture would be.
    }
    this.observer = new IntersectionObserver((entries) => {
      for (const { target, isIntersecting } of entries) {
        if (isIntersecting) this.#wait(target);
      }
    });
  }

  /** Put the thumbnail of a file into an element, when that comes into sight. */
  place(element, file) {
    element.dataset.file = file;
    if (!this.renderer) element.textContent = "look";
    else if (this.drawn.has(file)) this.#fill(element, this.drawn.get(file));
    else this.observer.observe(element);
  }

  /** Forget the elements that no thumbnail has been put into yet. */
  forgetPlaces() {
    this.observer.disconnect();
    this.waiting = [];
  }

  #wait(element) {
    this.observer.unobserve(element);
    this.waiting.push(element);
    this.working ??= this.#work().finally(() => (this.working = undefined));
  }

  async #work() {
    for (let element; (element = this.waiting.shift()); ) {
      const file = Number(element.dataset.file);
      if (!this.drawn.has(file)) this.drawn.set(file, await this.#picture(file));
      this.#fill(element, this.drawn.get(file));
    }
  }

  /** Return a picture of a file, or the message of what is wrong with it. */
  async #picture(file) {
    const element = this.files[file];
    try {
      const panel = new Panel({ ...element.dataset, ...(await this.decode(bytesOf(element))) });
      panel.upload(this.renderer, panel.box);
      panel.hide(this.renderer, new Map());
      panel.paint(this.renderer, panel.ownColouring(), null, 1);
      this.renderer.clear([1, 1, 1]);
      const place = [0, 0, WIDTH, HEIGHT];
      this.renderer.draw(panel.buffers, place, new Camera().matrices(WIDTH / HEIGHT), LOOK);
      this.renderer.forget(panel.buffers);
      return copyOf(this.renderer.canvas);
    } catch (error) {
      return error.message;
    }
  }

  #fill(element, picture) {
    if (typeof picture === "string") {
      Object.assign(element, { textContent: "damaged", title: picture });
      return;
    }
    element.replaceChildren(copyOf(picture));
  }
}

const canvasOf = () => Object.assign(document.createElement("canvas"), { width: WIDTH, height: HEIGHT });

function copyOf(picture) {
  const canvas = canvasOf();
  canvas.getContext("2d").drawImage(picture, 0, 0);
  return canvas;
}
