"use strict";
// What every page needs: its data, numbers as text, elements.

const $ = id => document.getElementById(id);

/** An element with a text; never markup. */
function make(tag, text, className) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (className) element.className = className;
  return element;
}

const count = n => n.toLocaleString("en");

/** Six significant digits. */
function digits(x) {
  if (x === null || x === undefined || Number.isNaN(x)) return "not known";
  if (x === 0) return "0";
  const size = Math.abs(x);
  if (size < 1e-4 || size >= 1e7) return x.toExponential(4).replace(/\.?0+e/, "e");
  return String(+x.toPrecision(6));
}

/** A time in the unit that suits it. */
function duration(seconds) {
  if (!(seconds >= 0)) return "not known";
  const [unit, name] = seconds >= 1 ? [1, "s"] : seconds >= 1e-3 ? [1e-3, "ms"] : [1e-6, "µs"];
  return `${+(seconds / unit).toPrecision(4)} ${name}`;
}

const share = x => `${x === 1 ? 100 : (100 * x).toFixed(1)} %`;

/** "1 contact", "2 contacts". */
const many = (n, what) => `${count(n)} ${what}${n === 1 ? "" : "s"}`;

/** Fills a list of names and values. */
function facts(list, lines) {
  // Long values have a line of their own where there are columns.
  list.replaceChildren(...lines.flatMap(([name, value]) => ["dt", "dd"].map((tag, k) => make(tag, [name, value][k], value.length > 48 ? "long" : ""))));
}

/** A colour of the style, which differs between light and dark. */
const style = name => getComputedStyle(document.body).getPropertyValue(name).trim();

/** Calls back when the page turns light or dark. */
const onScheme = then => matchMedia("(prefers-color-scheme: dark)").addEventListener("change", then);

function fromBase64(text) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(text);
  const letters = atob(text), bytes = new Uint8Array(letters.length);
  for (let k = 0; k < bytes.length; k++) bytes[k] = letters.charCodeAt(k);
  return bytes;
}

/** The header of the page's data, with its arrays by name in `arrays`. */
async function unpack() {
  const source = $("data");
  const packed = new Blob([fromBase64(source.textContent.trim())]).stream();
  source.remove();
  const buffer = await new Response(packed.pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  const length = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, length)));
  const all = new Uint8Array(buffer, 4 + length);
  let at = 0;
  header.arrays = {};
  for (const [name, kind, n] of header.sections) {
    const array = kind === "u32" ? new Uint32Array(n) : new Float64Array(n);
    const bytes = new Uint8Array(array.buffer), width = array.BYTES_PER_ELEMENT;
    for (let plane = 0; plane < width; plane++)
      for (let k = 0, to = plane; k < n; k++, to += width) bytes[to] = all[at++];
    header.arrays[name] = array;
  }
  return header;
}

const signed = z => (z >>> 1) ^ -(z & 1);

/** Adds up differences from the value `stride` places before, in place. */
function sums(array, stride) {
  for (let k = 0; k < array.length; k++) array[k] = signed(array[k]) + (k < stride ? 0 : array[k - stride]);
  return array;
}

/** Adds differences to another array. */
const added = (array, before) => array.map((z, k) => signed(z) + before[k]);

/** Runs the page; a failure is shown instead of nothing. */
function start(main) {
  window.ready = unpack().then(main).catch(error => {
    document.body.prepend(make("p", `This page cannot be shown: ${error.message}. It needs a browser of 2023 or later.`, "note"));
    throw error;
  });
}
