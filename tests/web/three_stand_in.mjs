// Stand-in for three.js: the classes that the loader of src/web takes from it, as far as it does.
import { readFile } from "node:fs/promises";

export class BufferAttribute {
  constructor(array, itemSize, normalized = false) {
    Object.assign(this, { array, itemSize, normalized, count: array.length / itemSize });
  }
}

export class BufferGeometry {
  constructor() {
    Object.assign(this, { attributes: {}, index: null, groups: [] });
  }

  setAttribute(name, attribute) {
    this.attributes[name] = attribute;
  }

  getAttribute(name) {
    return this.attributes[name];
  }

  setIndex(index) {
    this.index = index;
  }

  addGroup(start, count, materialIndex) {
    this.groups.push({ start, count, materialIndex });
  }

  computeVertexNormals() {
    this.hasComputedNormals = true;
  }
}

export class Loader {
  constructor(manager) {
    Object.assign(this, { manager, path: "", requestHeader: {}, withCredentials: false });
  }

  loadAsync(url) {
    return new Promise((resolve, reject) => this.load(url, resolve, undefined, reject));
  }
}

export class FileLoader extends Loader {
  setPath() {}
  setResponseType() {}
  setRequestHeader() {}
  setWithCredentials() {}

  load(url, onLoad, onProgress, onError) {
    readFile(url).then((bytes) => {
      onLoad(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
    }, onError);
  }
}
