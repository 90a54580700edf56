// The report page: lets the figure move, draws the curves, leads from numbers to lines of the model and back. The numbers come
// from `payload.rs`; the figure is drawn there too, and only moved and coloured here. No text of a model becomes markup here:
// elements are made one by one, and names are their text.
'use strict';
(() => {
  const SVG = 'http://www.w3.org/2000/svg';
  const editor = typeof acquireVsCodeApi === 'function' ? acquireVsCodeApi() : undefined;
  const $ = id => document.getElementById(id);
  const still = matchMedia('(prefers-reduced-motion: reduce)');

  // ---- how parts move: the same steps as `picture::stage`

  /** Where each part of a figure is for values q of the coordinates: from the page at rest to the page. */
  function places(figure, q) {
    const slots = new Float64Array(figure.slots);
    q.forEach((value, i) => { if (value) for (const [slot, factor] of figure.basis[i]) slots[slot] += factor * value; });
    // Joints that close loops stay together to second order.
    if (q.length) for (const [i, j, list] of figure.bends) for (const [slot, factor] of list) slots[slot] += factor * q[i] * q[j];
    const pieces = [];
    let slot = 0;
    for (const piece of figure.pieces) {
      const angle = piece.angle + slots[slot++];
      let [x, y] = [0, 0];
      for (const [dx, dy, rest] of piece.slides) {
        const way = rest + slots[slot++];
        x += dx * way; y += dy * way;
      }
      const on = pieces[piece.carrier] ?? { x: 0, y: 0, cos: 1, sin: 0, anchor: null };
      [x, y] = [on.cos * x - on.sin * y, on.sin * x + on.cos * y];
      if (piece.anchor && on.anchor) {
        const [dx, dy] = [piece.anchor[0] - on.anchor[0], piece.anchor[1] - on.anchor[1]];
        x += on.x + on.cos * dx - on.sin * dy;
        y += on.y + on.sin * dx + on.cos * dy;
      } else {
        x += on.x + (piece.anchor?.[0] ?? 0);
        y += on.y + (piece.anchor?.[1] ?? 0);
      }
      pieces.push({ x, y, cos: Math.cos(angle), sin: Math.sin(angle), anchor: piece.anchor });
    }
    return figure.parts.map(([index, fromX, fromY, ax, ay, bx, by]) => {
      const { x, y, cos, sin, anchor } = pieces[index];
      const [dx, dy] = [x - (anchor?.[0] ?? 0), y - (anchor?.[1] ?? 0)];
      return { x: fromX + ax * dx + bx * dy, y: fromY + ay * dx + by * dy, cos, sin };
    });
  }

  /** From a point of a part at rest to where it is now. The page's y runs downwards. */
  function moved(rest, now, x, y) {
    const [cos, sin] = [now.cos * rest.cos + now.sin * rest.sin, now.sin * rest.cos - now.cos * rest.sin];
    const [dx, dy] = [x - rest.x, y - rest.y];
    return [now.x + cos * dx + sin * dy, now.y - sin * dx + cos * dy];
  }

  /** The transform of a stroke that is stretched from [a, b] to [c, d], its width kept. */
  function stretched([ax, ay], [bx, by], [cx, cy], [dx, dy]) {
    const [ux, uy, vx, vy] = [bx - ax, by - ay, dx - cx, dy - cy];
    const before = Math.hypot(ux, uy), after = Math.hypot(vx, vy);
    if (before === 0 || after === 0) return [1, 0, 0, 1, cx - ax, cy - ay];
    const [ex, ey, fx, fy] = [ux / before, uy / before, vx / after, vy / after];
    const along = after / before;
    // along * f e^T + across(f) across(e)^T
    const m = [along * fx * ex + fy * ey, along * fy * ex - fx * ey, along * fx * ey - fy * ex, along * fy * ey + fx * ex];
    return [...m, cx - m[0] * ax - m[2] * ay, cy - m[1] * ax - m[3] * ay];
  }

  /** More names than this are left out while a figure moves: a browser takes longer for them than for everything else. */
  const MANY = 100;

  class Scene {
    constructor(figure, svg) {
      this.figure = figure;
      this.rest = places(figure, []);
      const numbers = text => text.trim().split(/[\s,]+/).map(Number);
      // Names are read at rest where there are very many.
      const many = svg.querySelectorAll('.label').length > MANY;
      svg.classList.toggle('many', many);
      this.rides = [...svg.querySelectorAll('[data-with], [data-at], [data-between]')].map(element => ({
        element,
        part: element.dataset.with === undefined ? undefined : Number(element.dataset.with),
        holds: (element.dataset.at ?? element.dataset.between ?? '').split(';').filter(Boolean).map(numbers),
      }));
    }

    /** Shows the figure for values of the coordinates. */
    show(q) {
      $('figure').classList.toggle('moved', q.length > 0);
      const now = places(this.figure, q);
      const hold = ([part, ofX, ofY, x, y]) => {
        const [toX, toY] = moved(this.rest[part], now[part], ofX, ofY);
        return [x + toX - ofX, y + toY - ofY];
      };
      for (const ride of this.rides) {
        const { element, part, holds } = ride;
        let m;
        if (part !== undefined) {
          const [e, f] = moved(this.rest[part], now[part], 0, 0);
          const [ax, ay] = moved(this.rest[part], now[part], 1, 0);
          m = [ax - e, ay - f, -(ay - f), ax - e, e, f];
        } else if (holds.length === 2) {
          const at = holds.map(h => h.slice(3));
          const to = holds.map(hold);
          m = element.localName === 'text'
            ? [1, 0, 0, 1, (to[0][0] + to[1][0] - at[0][0] - at[1][0]) / 2, (to[0][1] + to[1][1] - at[0][1] - at[1][1]) / 2]
            : stretched(at[0], at[1], to[0], to[1]);
        } else {
          const [x, y] = hold(holds[0]);
          m = [1, 0, 0, 1, x - holds[0][3], y - holds[0][4]];
        }
        const text = `matrix(${m.map(x => +x.toFixed(4)).join(' ')})`;
        if (text === ride.text) continue;
        ride.text = text;
        element.setAttribute('transform', text);
      }
    }
  }

  // ---- how a motion goes on

  /** Seconds that a period takes at speed 1, and cycles of a decay before it starts again. */
  const PERIOD = 2, LONGEST = 14;

  /** The factor exp(s t), scaled to at most one, after so many seconds of the page: [re, im]. */
  function factor([re, im], seconds) {
    if (re === 0 && im === 0) return [Math.cos(2 * Math.PI * seconds / (2 * PERIOD)), 0];
    if (im === 0) {
      // A decay or growth by e in each period; from a twentieth to one, or back.
      const size = 3 * ((seconds / PERIOD / 3) % 1);
      return [re < 0 ? Math.exp(-size) : Math.exp(size - 3), 0];
    }
    const decay = re / im;
    const span = Math.max(1, Math.min(LONGEST, Math.floor(3 / (2 * Math.PI * Math.abs(decay)))));
    const cycles = (seconds / PERIOD) % (decay === 0 ? Infinity : span);
    const phase = 2 * Math.PI * cycles;
    const size = decay > 0 ? Math.exp(decay * (phase - 2 * Math.PI * span)) : Math.exp(decay * phase);
    return [size * Math.cos(phase), size * Math.sin(phase)];
  }

  /** The coordinates of a motion at such a factor. */
  const shape = ({ q, qi, amount }, [re, im], scale) => q.map((x, i) => scale * amount * (x * re - (qi?.[i] ?? 0) * im));

  let state = { motion: 0, playing: undefined, speed: 1, scale: 1, seconds: 0, input: 0, output: 0, view: 'bode', unit: 0 };
  let page, scene, frame = 0, redraw = [];

  function player() {
    const svg = document.querySelector('#figure svg');
    scene = undefined;
    if (!svg || !page.figure) return;
    scene = new Scene(page.figure, svg);
    const select = $('motion');
    if (!select) return;
    const entries = page.motions;
    state.motion = Math.min(state.motion, entries.length - 1);
    select.value = String(state.motion);
    const controls = { speed: $('speed'), scale: $('scale'), phase: $('phase') };
    controls.speed.value = String(state.speed);
    controls.scale.value = String(state.scale);
    const chosen = () => entries[state.motion];
    const until = () => page.motion.times.at(-1);
    const cycle = motion => (motion.kind === 'time' ? 5 * PERIOD : motion.s[0] === 0 && motion.s[1] === 0 ? 2 * PERIOD : PERIOD);

    function draw() {
      const motion = chosen();
      if (motion.kind === 'time') {
        const at = (state.seconds / cycle(motion)) % 1 * (page.motion.times.length - 1);
        const [k, part] = [Math.floor(at), at % 1];
        const [a, b] = [page.motion.states[k], page.motion.states[Math.min(k + 1, page.motion.times.length - 1)]];
        scene.show(a.map((x, i) => state.scale * motion.amount * (x + part * (b[i] - x))));
        moveTimeCursor(until() * at / (page.motion.times.length - 1));
      } else {
        scene.show(shape(motion, factor(motion.s, state.seconds), state.scale));
      }
      controls.phase.value = String(Math.round(360 * (state.seconds / cycle(motion) % 1)));
    }

    function colour() {
      const energy = chosen().energy ?? [];
      const places = new Map(page.items.map((item, place) => [item, place]));
      for (const glyph of svg.querySelectorAll('[data-item]')) {
        const share = Math.max(0, Math.min(1, energy[places.get(glyph.dataset.item)] ?? 0));
        glyph.classList.toggle('hot', share > 0);
        glyph.style.setProperty('--share', String(share));
      }
      const says = $('says');
      says.textContent = chosen().says;
      document.querySelectorAll('#poles .mark').forEach(mark => mark.classList.toggle('chosen', mark.dataset.motion === String(state.motion)));
    }

    let last;
    function tick(now) {
      if (last !== undefined) state.seconds += (now - last) / 1000 * state.speed;
      last = now;
      draw();
      frame = requestAnimationFrame(tick);
    }
    function play(on) {
      state.playing = on;
      cancelAnimationFrame(frame);
      last = undefined;
      $('play').textContent = on ? 'Pause' : 'Play';
      document.body.classList.toggle('moves', on);
      if (on) frame = requestAnimationFrame(tick);
    }
    function choose(index) {
      Object.assign(state, { motion: index, seconds: 0 });
      select.value = String(index);
      colour();
      draw();
    }

    select.onchange = () => choose(Number(select.value));
    $('play').onclick = () => play(!state.playing);
    $('rest').onclick = () => { play(false); scene.show([]); };
    controls.speed.oninput = () => { state.speed = Number(controls.speed.value); };
    controls.scale.oninput = () => { state.scale = Number(controls.scale.value); draw(); };
    controls.phase.oninput = () => {
      play(false);
      state.seconds = Number(controls.phase.value) / 360 * cycle(chosen());
      draw();
    };
    document.querySelectorAll('[data-motion]').forEach(element => { element.onclick = () => choose(Number(element.dataset.motion)); });
    colour();
    if (state.playing === undefined ? !still.matches && document.visibilityState === 'visible' && !document.body.dataset.still : state.playing) play(true);
    else { play(false); if (state.seconds) draw(); }
    window.onbeforeprint = () => {
      play(false);
      scene.show([]);
      document.querySelectorAll('details').forEach(details => { details.open = true; });
    };
    player.choose = choose;
  }

  // ---- charts

  function make(parent, name, attributes, text) {
    const element = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
    if (text !== undefined) element.textContent = text;
    parent.append(element);
    return element;
  }

  /** A number in few characters, for axes and readings. */
  function short(x, digits = 4) {
    if (x === 0) return '0';
    const size = Math.abs(x);
    return size >= 1e5 || size < 1e-3 ? x.toExponential(Math.min(digits - 1, 3)).replace(/\.?0+e/, 'e').replace('e+', 'e') : String(+x.toPrecision(digits));
  }

  function ticks({ lo, hi, log, step: given }, most) {
    if (log && hi / lo > 8 && hi / lo < 2000) {
      const list = [];
      for (let e = Math.floor(Math.log10(lo)); 10 ** e <= hi; e++) list.push(...[1, 2, 5].map(k => k * 10 ** e));
      return list.filter(tick => tick >= lo * (1 - 1e-9) && tick <= hi * (1 + 1e-9));
    }
    if (log && hi / lo > 8) {
      const [from, to] = [Math.ceil(Math.log10(lo) - 1e-9), Math.floor(Math.log10(hi) + 1e-9)];
      const step = Math.max(1, Math.ceil((to - from) / most));
      const list = [];
      for (let e = from; e <= to; e += step) list.push(10 ** e);
      return list;
    }
    const rough = (hi - lo) / most, unit = 10 ** Math.floor(Math.log10(rough));
    const step = given ?? [1, 2, 5, 10].map(k => k * unit).find(step => step >= rough);
    const list = [];
    for (let k = Math.ceil(lo / step); k * step <= hi * (1 + 1e-12); k++) list.push(k * step);
    return list;
  }

  const EDGE = { left: 74, right: 14, top: 10, bottom: 42 };

  /** Draws axes, curves and marks; returns the mapping of both axes. */
  function chart(svg, { x, y, height, curves = [], marks = [], lines = [], equal }) {
    svg.replaceChildren();
    const width = Math.max(260, Math.round(svg.getBoundingClientRect().width) || 640);
    svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
    svg.setAttribute('height', height);
    const [w, h] = [width - EDGE.left - EDGE.right, height - EDGE.top - EDGE.bottom];
    if (equal) {
      const per = Math.max((x.hi - x.lo) / w, (y.hi - y.lo) / h);
      for (const [axis, px] of [[x, w], [y, h]]) {
        const middle = (axis.lo + axis.hi) / 2;
        [axis.lo, axis.hi] = [middle - per * px / 2, middle + per * px / 2];
      }
    }
    const part = (axis, value) => (axis.log ? Math.log(value / axis.lo) / Math.log(axis.hi / axis.lo) : (value - axis.lo) / (axis.hi - axis.lo));
    const toX = value => EDGE.left + w * part(x, value), toY = value => EDGE.top + h * (1 - part(y, value));
    for (const tick of ticks(x, w / 90)) {
      make(svg, 'line', { class: 'grid', x1: toX(tick), x2: toX(tick), y1: EDGE.top, y2: EDGE.top + h });
      make(svg, 'text', { x: toX(tick), y: EDGE.top + h + 16, 'text-anchor': 'middle' }, short(tick));
    }
    for (const tick of ticks(y, h / 45)) {
      make(svg, 'line', { class: 'grid', x1: EDGE.left, x2: EDGE.left + w, y1: toY(tick), y2: toY(tick) });
      make(svg, 'text', { x: EDGE.left - 6, y: toY(tick) + 4, 'text-anchor': 'end' }, short(tick));
    }
    make(svg, 'text', { x: EDGE.left + w / 2, y: height - 6, 'text-anchor': 'middle' }, x.title);
    make(svg, 'text', { transform: `translate(14 ${EDGE.top + h / 2}) rotate(-90)`, 'text-anchor': 'middle' }, y.title);
    make(svg, 'rect', { class: 'frame', x: EDGE.left, y: EDGE.top, width: w, height: h });
    const inside = make(svg, 'svg', { x: 0, y: EDGE.top, width, height: h, viewBox: `0 ${EDGE.top} ${width} ${h}`, overflow: 'hidden' });
    const body = make(inside, 'svg', { x: EDGE.left, y: EDGE.top, width: w, height: h, viewBox: `${EDGE.left} ${EDGE.top} ${w} ${h}`, overflow: 'hidden' });
    const far = value => Math.max(-1e5, Math.min(1e5, value));
    for (const { from, to, text } of lines) {
      make(body, 'line', { class: 'damping', x1: far(toX(from[0])), y1: far(toY(from[1])), x2: far(toX(to[0])), y2: far(toY(to[1])) });
      if (text) make(body, 'text', { x: far(toX(text.at[0])), y: far(toY(text.at[1])), 'text-anchor': 'middle' }, text.text);
    }
    curves.forEach(({ points, style }) => {
      let path = '', pen = 'M', before;
      for (const [a, b] of points) {
        if (!Number.isFinite(b) || (y.log && b <= 0)) { pen = 'M'; continue; }
        // Where a phase turns over the line is lifted.
        if (y.wraps && before !== undefined && Math.abs(b - before) > 180) pen = 'M';
        before = b;
        path += `${pen}${far(toX(a)).toFixed(2)} ${far(toY(b)).toFixed(2)}`;
        pen = 'L';
      }
      make(body, 'path', { class: `curve s${style % 4}`, d: path });
    });
    for (const { at, title, motion, down } of marks) {
      const [px, py] = [far(toX(at[0])), far(toY(at[1]))];
      const mark = make(body, 'path', { class: 'mark', d: down ? `M${px} ${py + 1}l-5 9h10z` : `M${px} ${py - 1}l-5 -9h10z` });
      if (motion !== undefined) {
        mark.setAttribute('d', `M${px - 4} ${py - 4}l8 8m0 -8l-8 8`);
        mark.dataset.motion = String(motion);
      }
      make(mark, 'title', {}, title);
    }
    return { toX, toY, body, width, height: h, value: px => (x.log ? x.lo * (x.hi / x.lo) ** ((px - EDGE.left) / w) : x.lo + (x.hi - x.lo) * (px - EDGE.left) / w) };
  }

  // ---- transfer functions

  /** The value at a frequency in Hz: [re, im]. */
  function gain(pair, hertz) {
    if (pair.samples) return pair.samples.find(([f]) => f >= hertz)?.slice(1) ?? [NaN, NaN];
    if (pair.b) return solved(pair, 2 * Math.PI * hertz);
    const w = 2 * Math.PI * hertz, w2 = w * w;
    let [re, im] = [pair.feed[0] - pair.feed[2] * w2, pair.feed[1] * w];
    for (const [power, n0, n1, d0, d1, d2] of pair.terms) {
      const [br, bi] = [d0 - d2 * w2, d1 * w], size = br * br + bi * bi;
      let [vr, vi] = [(n0 * br + n1 * w * bi) / size, (n1 * w * br - n0 * bi) / size];
      for (let k = 0; k < power; k++) [vr, vi] = [-vi * w, vr * w];
      re += vr; im += vi;
    }
    return [re, im];
  }

  /** p(s) Q(s)^-1 b(s) at s = i w, where poles are not simple: by elimination with pivots, on rows and columns of one size. */
  function solved(pair, w) {
    const n = page.transfer.size, row = 2 * n + 2;
    const q = Array.from({ length: n }, () => new Float64Array(row));
    const size = new Float64Array(n).fill(1);
    for (const [i, j, m, c, k] of page.transfer.matrices) {
      q[i][2 * j] = k - m * w * w;
      q[i][2 * j + 1] = c * w;
      if (i === j) size[i] = 1 / Math.sqrt(Math.abs(m) * w * w + Math.abs(c) * w + Math.abs(k));
    }
    q.forEach((own, i) => { for (let j = 0; j < n; j++) { own[2 * j] *= size[i] * size[j]; own[2 * j + 1] *= size[i] * size[j]; } });
    const turned = (power, x) => [[x, 0], [0, x * w], [-x * w * w, 0]][power];
    for (const [power, i, x] of pair.b) { const [re, im] = turned(power, x); q[i][2 * n] += re * size[i]; q[i][2 * n + 1] += im * size[i]; }
    for (let k = 0; k < n; k++) {
      let best = k;
      for (let i = k + 1; i < n; i++) if (Math.hypot(q[i][2 * k], q[i][2 * k + 1]) > Math.hypot(q[best][2 * k], q[best][2 * k + 1])) best = i;
      [q[k], q[best]] = [q[best], q[k]];
      const [pr, pi] = [q[k][2 * k], q[k][2 * k + 1]], below = pr * pr + pi * pi;
      for (let i = k + 1; i < n; i++) {
        const [fr, fi] = [(q[i][2 * k] * pr + q[i][2 * k + 1] * pi) / below, (q[i][2 * k + 1] * pr - q[i][2 * k] * pi) / below];
        if (fr === 0 && fi === 0) continue;
        for (let j = 2 * k + 2; j < row; j += 2) {
          const [a, b] = [q[k][j], q[k][j + 1]];
          q[i][j] -= fr * a - fi * b;
          q[i][j + 1] -= fr * b + fi * a;
        }
      }
    }
    const x = Array.from({ length: n }, () => [0, 0]);
    for (let i = n - 1; i >= 0; i--) {
      let [re, im] = [q[i][2 * n], q[i][2 * n + 1]];
      for (let j = i + 1; j < n; j++) { re -= q[i][2 * j] * x[j][0] - q[i][2 * j + 1] * x[j][1]; im -= q[i][2 * j] * x[j][1] + q[i][2 * j + 1] * x[j][0]; }
      const [pr, pi] = [q[i][2 * i], q[i][2 * i + 1]], below = pr * pr + pi * pi;
      x[i] = [(re * pr + im * pi) / below, (im * pr - re * pi) / below];
    }
    const value = [pair.feed[0] - pair.feed[2] * w * w, pair.feed[1] * w];
    for (const [power, i, weight] of pair.p) {
      const [re, im] = turned(power, weight * size[i]);
      value[0] += re * x[i][0] - im * x[i][1];
      value[1] += re * x[i][1] + im * x[i][0];
    }
    return value;
  }

  /** Frequencies of a window: one for each pixel, and more and more densely beside each pole. */
  function frequencies(lo, hi, count, centres) {
    const list = [];
    for (let k = 0; k <= count; k++) list.push(lo * (hi / lo) ** (k / count));
    for (const f of centres) {
      for (let e = 1; e <= 12; e += 0.25) list.push(f * (1 - 10 ** -e), f * (1 + 10 ** -e));
      list.push(f);
    }
    return list.filter(f => f >= lo && f <= hi).sort((a, b) => a - b);
  }

  function transfer() {
    const data = page.transfer;
    if (!data) return;
    const [from, to, view, reading] = [$('from'), $('to'), $('view'), $('reading')];
    const [upper, lower] = [$('gain'), $('phase-plot')];
    [state.input, state.output] = [Math.min(state.input, data.inputs.length - 1), Math.min(state.output, data.outputs.length - 1)];
    [from.value, to.value, view.value] = [String(state.input), String(state.output), state.view];
    let [lo, hi] = data.range, cursor, maps = [], curve = [];

    function draw() {
      const pair = data.pairs[state.input][state.output];
      const [input, output] = [data.inputs[state.input], data.outputs[state.output]];
      const list = !pair.samples ? frequencies(lo, hi, pair.b ? 500 : 900, data.centres) : pair.samples.map(([f]) => f).filter(f => f >= lo && f <= hi);
      const values = list.map(f => [f, ...gain(pair, f)]);
      const unit = output.unit === input.unit ? '' : ` [${output.unit || '1'}/${/[*/ ]/.test(input.unit) ? `(${input.unit})` : input.unit}]`;
      if (state.view === 'nyquist') {
        const finite = values.filter(([, re, im]) => Number.isFinite(re) && Number.isFinite(im));
        const most = Math.max(...finite.map(([, re, im]) => Math.max(Math.abs(re), Math.abs(im)))) || 1;
        const bound = (i, pick) => pick(0, ...finite.map(v => v[i]));
        const axis = (i, title) => ({ lo: bound(i, Math.min) - most * 0.05, hi: bound(i, Math.max) + most * 0.05, title });
        lower.replaceChildren();
        lower.setAttribute('height', 0);
        maps = [chart(upper, { x: axis(1, `real part${unit}`), y: axis(2, `imaginary part${unit}`), height: 420, equal: true, curves: [{ points: finite.map(([, re, im]) => [re, im]), style: 0 }] })];
        curve = finite;
      } else {
        const sizes = values.map(([f, re, im]) => [f, Math.hypot(re, im)]);
        const known = sizes.map(([, g]) => g).filter(g => g > 0 && Number.isFinite(g));
        let [bottom, top] = [Math.min(...known), Math.max(...known)];
        bottom = Math.max(bottom, top * 1e-8);
        const x = { lo, hi, log: true, title: 'frequency [Hz]' };
        // Room for marks above the highest peak and below the lowest dip.
        const room = (1.5 * top / bottom) ** 0.07;
        const y = { lo: bottom / room, hi: top * room, log: true, title: `gain${unit}` };
        const shown = pair.marks.filter(mark => mark.f >= lo && mark.f <= hi);
        const marks = shown.map(mark => ({ at: [mark.f, Math.min(top, Math.max(bottom, mark.gain ?? (mark.down ? 0 : Infinity)))], title: mark.title, down: mark.down }));
        const phases = values.map(([f, re, im]) => [f, Math.atan2(im, re) * 180 / Math.PI]);
        maps = [
          chart(upper, { x: { ...x }, y, height: 300, curves: [{ points: sizes, style: 0 }], marks }),
          chart(lower, { x: { ...x }, y: { lo: -190, hi: 190, title: 'phase [deg]', wraps: true, step: 90 }, height: 210, curves: [{ points: phases, style: 0 }] }),
        ];
      }
      read();
      document.querySelectorAll('#features [data-pair]').forEach(table => { table.hidden = table.dataset.pair !== `${state.input} ${state.output}`; });
    }

    function read() {
      for (const { body } of maps) body.querySelectorAll('.cursor').forEach(line => line.remove());
      if (cursor === undefined) { reading.textContent = ''; return; }
      cursor = Math.min(hi, Math.max(lo, cursor));
      const [re, im] = gain(data.pairs[state.input][state.output], cursor);
      for (const { body, toX, toY } of maps) {
        if (state.view !== 'nyquist') make(body, 'line', { class: 'cursor', x1: toX(cursor), x2: toX(cursor), y1: 0, y2: 1000 });
        else if (Number.isFinite(re) && Number.isFinite(im)) make(body, 'circle', { class: 'cursor', cx: toX(re), cy: toY(im), r: 5, fill: 'none' });
      }
      const size = Math.hypot(re, im);
      reading.textContent = `${short(cursor, 5)} Hz: gain ${short(size)} (${(20 * Math.log10(size)).toFixed(1)} dB), phase ${(Math.atan2(im, re) * 180 / Math.PI).toFixed(1)}°`;
    }

    function window_(by, about) {
      const centre = about ?? cursor ?? Math.sqrt(lo * hi);
      const [a, b] = [centre * (lo / centre) ** by, centre * (hi / centre) ** by];
      // Closer than the digits of a frequency there is nothing to see.
      if (b / a < 1 + 1e-9 || b / a > 1e12) return;
      [lo, hi] = [a, b];
      draw();
    }
    const shift = by => { const way = (hi / lo) ** by; [lo, hi] = [lo * way, hi * way]; draw(); };

    /** The frequency whose point of the Nyquist plot is nearest. */
    function nearest(px, py) {
      const { toX, toY } = maps[0];
      const way = ([, re, im]) => Math.hypot(toX(re) - px, toY(im) - py);
      return curve.reduce((best, point) => (best && way(best) <= way(point) ? best : point), undefined)?.[0];
    }

    // Two fingers: closer and wider about the middle between them.
    const fingers = new Map();
    function pinched() {
      const [a, b] = [...fingers.values()];
      return [Math.max(20, Math.abs(a[0] - b[0])), (a[0] + b[0]) / 2];
    }

    from.onchange = () => { state.input = Number(from.value); draw(); };
    to.onchange = () => { state.output = Number(to.value); draw(); };
    view.onchange = () => { state.view = view.value; draw(); };
    $('closer').onclick = () => window_(0.5);
    $('wider').onclick = () => window_(2);
    $('whole').onclick = () => { [lo, hi] = data.range; cursor = undefined; draw(); };
    for (const svg of [upper, lower]) {
      svg.onpointerdown = event => { if (event.pointerType === 'touch') fingers.set(event.pointerId, [event.clientX, event.clientY]); };
      svg.onpointerup = svg.onpointercancel = svg.onpointerleave = event => fingers.delete(event.pointerId);
      svg.onpointermove = event => {
        if (!maps[0]) return;
        const box = svg.getBoundingClientRect(), per = maps[0].width / box.width;
        if (fingers.has(event.pointerId)) {
          const before = fingers.size === 2 ? pinched() : undefined;
          fingers.set(event.pointerId, [event.clientX, event.clientY]);
          if (before && state.view !== 'nyquist') {
            const [now, middle] = pinched();
            window_(before[0] / now, maps[0].value((middle - box.left) * per));
            return;
          }
        }
        const [px, py] = [(event.clientX - box.left) * per, (event.clientY - box.top) * per];
        cursor = state.view === 'nyquist' ? nearest(px, py) : maps[0].value(px);
        read();
      };
      svg.onwheel = event => {
        // Scrolling stays scrolling.
        if (!event.ctrlKey || state.view === 'nyquist') return;
        event.preventDefault();
        window_(event.deltaY > 0 ? 1.25 : 0.8, cursor);
      };
      svg.onkeydown = event => {
        const step = (hi / lo) ** (1 / 200);
        const keys = {
          ArrowRight: () => { cursor = (cursor ?? lo) * step; read(); },
          ArrowLeft: () => { cursor = (cursor ?? hi) / step; read(); },
          '+': () => window_(0.5), '-': () => window_(2),
          PageDown: () => shift(0.25), PageUp: () => shift(-0.25),
        };
        if (!keys[event.key]) return;
        event.preventDefault();
        keys[event.key]();
      };
    }
    redraw.push(draw);
    draw();
  }

  // ---- poles and motion over time

  function poles() {
    const svg = $('poles');
    if (!svg) return;
    const draw = () => {
      const list = page.poles;
      const size = Math.max(...list.map(({ s }) => Math.hypot(...s))) || 1;
      const left = Math.min(0, ...list.map(({ s }) => s[0])), right = Math.max(0, ...list.map(({ s }) => s[0]));
      const x = { lo: Math.min(left * 1.15, -0.1 * size), hi: Math.max(right * 1.15, 0.1 * size), title: 'real part [1/s]' };
      const y = { lo: -1.1 * size, hi: 1.1 * size, title: 'imaginary part [rad/s]' };
      const lines = [{ from: [0, -9 * size], to: [0, 9 * size] }, { from: [-9 * size, 0], to: [9 * size, 0] }];
      for (const ratio of [0.05, 0.1, 0.2, 0.4, 0.7]) {
        const [re, im] = [-ratio, Math.sqrt(1 - ratio * ratio)];
        // Where the line leaves the chart, less a little.
        const reach = 0.93 * Math.min(x.lo / re, y.hi / im);
        const text = { at: [re * reach, im * reach], text: `ζ ${ratio}` };
        lines.push({ from: [0, 0], to: [9 * size * re, 9 * size * im], text }, { from: [0, 0], to: [9 * size * re, -9 * size * im] });
      }
      chart(svg, { x, y, height: 340, lines, marks: list.map(({ s, title, motion }) => ({ at: s, title, motion: motion ?? '' })) });
      svg.querySelectorAll('.mark[data-motion]').forEach(mark => {
        if (mark.dataset.motion !== '') mark.onclick = () => player.choose?.(Number(mark.dataset.motion));
      });
    };
    redraw.push(draw);
    draw();
  }

  /** Bars: by how many percent a measure changes for one percent of each parameter, the largest first. */
  function slopes() {
    const svg = $('bars');
    if (!svg || !page.slopes) return;
    const { parameters, values } = page.slopes, select = $('slope');
    state.slope = Math.min(state.slope ?? 0, values[0].length - 1);
    select.value = String(state.slope);
    const draw = () => {
      const all = parameters.map((name, i) => ({ name, value: values[i][state.slope] })).filter(({ value }) => value !== null);
      const list = all.sort((a, b) => Math.abs(b.value) - Math.abs(a.value)).slice(0, 20);
      const width = Math.max(260, Math.round(svg.getBoundingClientRect().width) || 640), left = Math.min(160, width / 3), row = 22;
      const [low, high] = [Math.min(0, ...list.map(({ value }) => value)), Math.max(0, ...list.map(({ value }) => value))];
      const toX = value => left + 56 + (width - left - 112) * (high > low ? (value - low) / (high - low) : 0);
      const height = row * Math.max(1, list.length) + 8;
      svg.replaceChildren();
      svg.setAttribute('viewBox', `0 0 ${width} ${height}`);
      svg.setAttribute('height', height);
      if (!list.length) make(svg, 'text', { x: 4, y: row }, 'no parameter has a derivative');
      list.forEach(({ name, value }, i) => {
        const y = 4 + i * row, room = Math.floor((left - 8) / 7.5);
        const label = make(svg, 'text', { x: left - 6, y: y + 15, 'text-anchor': 'end' }, name.length > room ? `${name.slice(0, room - 1)}…` : name);
        make(label, 'title', {}, name);
        make(svg, 'rect', { class: 'bar', x: Math.min(toX(0), toX(value)), y: y + 3, width: Math.max(0.5, Math.abs(toX(value) - toX(0))), height: row - 6 });
        make(svg, 'text', { x: toX(value) + (value < 0 ? -4 : 4), y: y + 15, 'text-anchor': value < 0 ? 'end' : 'start' }, short(value, 3));
      });
      if (list.length) make(svg, 'line', { class: 'frame', x1: toX(0), x2: toX(0), y1: 0, y2: height });
    };
    select.onchange = () => { state.slope = Number(select.value); draw(); };
    redraw.push(draw);
    draw();
  }

  let moveTimeCursor = () => {};

  function motion() {
    const svg = $('history');
    moveTimeCursor = () => {};
    if (!svg || !page.motion) return;
    const { times, outputs } = page.motion, units = [...new Set(outputs.map(({ unit }) => unit))];
    const select = $('unit');
    let map;
    const draw = () => {
      const own = outputs.map((output, style) => ({ ...output, style })).filter(({ unit }) => unit === units[state.unit]);
      const all = own.flatMap(({ values }) => values).filter(Number.isFinite);
      const [low, high] = [Math.min(...all), Math.max(...all)], room = (high - low) * 0.06 || Math.abs(high) * 0.1 || 1;
      const curves = own.map(({ values, style }) => ({ points: values.map((value, i) => [times[i], value]), style }));
      map = chart(svg, { x: { lo: times[0], hi: times.at(-1), title: 'time [s]' }, y: { lo: low - room, hi: high + room, title: `${own.map(({ name }) => name).join(', ')} [${units[state.unit]}]` }, height: 280, curves });
    };
    moveTimeCursor = time => {
      map.body.querySelectorAll('.cursor').forEach(line => line.remove());
      make(map.body, 'line', { class: 'cursor', x1: map.toX(time), x2: map.toX(time), y1: 0, y2: 1000 });
    };
    if (select) {
      state.unit = Math.min(state.unit, units.length - 1);
      select.value = String(state.unit);
      select.onchange = () => { state.unit = Number(select.value); draw(); };
    }
    redraw.push(draw);
    draw();
  }

  // ---- from numbers to lines and back

  /** Marks what a line of the model made, and the line. */
  function highlight(line, options = {}) {
    document.querySelectorAll('.here').forEach(element => element.classList.remove('here'));
    if (!line) return;
    const all = [...document.querySelectorAll(`[data-line="${line}"]`), $(`L${line}`)].filter(Boolean);
    all.forEach(element => element.classList.add('here'));
    if (options.scroll) $(`L${line}`)?.scrollIntoView({ block: 'center' });
    if (options.figure) document.querySelector('#figure .here')?.scrollIntoView({ block: 'nearest' });
    if (options.tell) editor?.postMessage({ line });
  }

  document.addEventListener('click', event => {
    const at = event.target.closest('[data-line], .text li');
    if (!at) return;
    const own = at.matches('.text li');
    const line = own ? Number(at.id.slice(1)) : Number(at.dataset.line);
    if (event.target.closest('a')) event.preventDefault();
    highlight(line, { scroll: !own, figure: own, tell: true });
  });
  window.addEventListener('hashchange', () => {
    const line = /^#L(\d+)$/.exec(location.hash);
    if (line) highlight(Number(line[1]), { scroll: true });
  });

  // ---- the page as a whole

  function start() {
    cancelAnimationFrame(frame);
    redraw = [];
    page = JSON.parse($('payload').textContent);
    motion();
    poles();
    player();
    transfer();
    slopes();
  }

  /** Puts another version of the page in the place of this one; what was chosen stays chosen. */
  function replace(text) {
    const next = new DOMParser().parseFromString(text, 'text/html');
    for (const id of ['page', 'payload']) $(id).replaceWith(document.adoptNode(next.getElementById(id)));
    document.title = next.title;
    start();
  }

  let waiting;
  window.addEventListener('resize', () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => redraw.forEach(draw => draw()), 100);
  });
  if (editor) {
    window.addEventListener('message', ({ data }) => {
      if (typeof data?.page === 'string') replace(data.page);
      if (typeof data?.line === 'number') highlight(data.line, { figure: true });
    });
    editor.postMessage({ ready: true });
  }
  if (document.body.dataset.live) {
    let version = document.body.dataset.live;
    new EventSource('events').onmessage = async ({ data }) => {
      if (data === version) return;
      version = data;
      replace(await (await fetch('page')).text());
    };
  }
  start();
})();
