// Copyright (c) 2026, the TSAR for COLMAP authors.
// SPDX-License-Identifier: BSD-3-Clause
//
// A viewer of point clouds and of meshes: turns about what is up, by mouse, touch
// and keys.

"use strict";

window.TsarPoints = (() => {
  const VERTEX = `
    attribute vec3 position;
    attribute vec3 color;
    uniform mat4 view;
    uniform mat4 projection;
    uniform float size;
    uniform float brightness;
    varying vec3 shade;
    void main() {
      vec4 seen = view * vec4(position, 1.0);
      gl_Position = projection * seen;
      gl_PointSize = clamp(size / max(-seen.z, 1e-6), 1.0, 24.0);
      shade = brightness * color;
    }`;
  const FRAGMENT = `
    precision mediump float;
    varying vec3 shade;
    void main() { gl_FragColor = vec4(shade, 1.0); }`;
  const FIELD_OF_VIEW = 0.9; // Of the shorter side, in radians.
  const BACKGROUND = [0.086, 0.098, 0.118];

  const add = (a, b, s = 1) => a.map((value, i) => value + s * b[i]);
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [
    a[1] * b[2] - a[2] * b[1],
    a[2] * b[0] - a[0] * b[2],
    a[0] * b[1] - a[1] * b[0],
  ];
  const norm = (a) => Math.sqrt(dot(a, a));
  const unit = (a) => a.map((value) => value / (norm(a) || 1));

  // A direction at right angles to this one.
  function across(up) {
    const axis = Math.abs(up[0]) < 0.9 ? [1, 0, 0] : [0, 1, 0];
    return unit(cross(up, axis));
  }

  // The middle of the points, and the radius that holds most of them: a few
  // points far away must not make all others small.
  function extent(positions) {
    const count = positions.length / 3;
    const step = Math.max(1, Math.floor(count / 5000));
    const sorted = [[], [], []];
    for (let i = 0; i < count; i += step) {
      for (let axis = 0; axis < 3; ++axis) {
        sorted[axis].push(positions[3 * i + axis]);
      }
    }
    sorted.forEach((values) => values.sort((a, b) => a - b));
    const at = (axis, share) =>
      sorted[axis][Math.floor(share * (sorted[axis].length - 1))] || 0;
    const middle = [0, 1, 2].map((axis) => (at(axis, 0.03) + at(axis, 0.97)) / 2);
    const size = [0, 1, 2].map((axis) => at(axis, 0.97) - at(axis, 0.03));
    return { middle, radius: Math.max(norm(size) / 2, 1e-6) };
  }

  function compile(gl) {
    const program = gl.createProgram();
    for (const [type, source] of [
      [gl.VERTEX_SHADER, VERTEX],
      [gl.FRAGMENT_SHADER, FRAGMENT],
    ]) {
      const shader = gl.createShader(type);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.bindAttribLocation(program, 0, "position");
    gl.bindAttribLocation(program, 1, "color");
    gl.linkProgram(program);
    return gl.getProgramParameter(program, gl.LINK_STATUS) ? program : null;
  }

  class View {
    // Throws where the browser has no WebGL.
    // target: what eye looks at first; without it, the middle of what is framed,
    // from as far away as is needed to see it whole.
    constructor(canvas, eye, up, target = null) {
      this.canvas = canvas;
      this.gl = canvas.getContext("webgl", { antialias: true });
      this.program = this.gl && compile(this.gl);
      if (!this.program) {
        throw new Error("no WebGL");
      }
      this.clouds = {};
      this.shown = null;
      this.pointSize = 1;
      this.parts = null;
      this.showsBacks = false;
      this.firstEye = eye;
      this.firstTarget = target;
      this.up = unit(up);
      this.pending = false;
      this.listen();
      new ResizeObserver(() => this.request()).observe(canvas);
    }

    // positions: Float32Array; colors: Uint8Array; three of each per point.
    // framed: the positions that frame() goes by, if not all of these.
    add(name, positions, colors, framed = positions) {
      const gl = this.gl;
      const buffer = (data) => {
        const made = gl.createBuffer();
        gl.bindBuffer(gl.ARRAY_BUFFER, made);
        gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
        return made;
      };
      this.clouds[name] = {
        count: positions.length / 3,
        positions: buffer(positions),
        colors: buffer(colors),
        extent: extent(framed),
      };
    }

    // Relative to how far the points would be apart if they covered the scene.
    setPointSize(size) {
      this.pointSize = size;
      this.request();
    }

    show(name) {
      this.shown = name;
      this.request();
    }

    // Draws triangles instead of points, three vertices each: a list of
    // { first, count, brightness }. showsBacks: also from the side from which they
    // run clockwise; otherwise one looks through them there.
    showTriangles(parts, showsBacks) {
      this.parts = parts;
      this.showsBacks = showsBacks;
      this.request();
    }

    // Shows this cloud from the first viewpoint.
    frame(name) {
      const { middle, radius } = this.clouds[name].extent;
      this.target = this.firstTarget || middle;
      this.radius = radius;
      const away = add(this.firstEye, this.target, -1);
      this.distance = this.firstTarget
        ? norm(away)
        : Math.max(norm(away) * 1.2, radius * 1.1);
      const height = dot(unit(away), this.up);
      const flat = add(away, this.up, -dot(away, this.up));
      this.east = norm(flat) > 1e-6 ? unit(flat) : across(this.up);
      this.north = cross(this.up, this.east);
      this.azimuth = 0;
      this.elevation = Math.asin(Math.max(-1, Math.min(1, height)));
      this.request();
    }

    direction() {
      const flat = add(
        this.east.map((value) => value * Math.cos(this.azimuth)),
        this.north,
        Math.sin(this.azimuth)
      );
      return add(
        flat.map((value) => value * Math.cos(this.elevation)),
        this.up,
        Math.sin(this.elevation)
      );
    }

    rotate(right, down) {
      this.azimuth -= right;
      this.elevation = Math.max(-1.5, Math.min(1.5, this.elevation + down));
      this.request();
    }

    zoom(factor) {
      const limit = (value) =>
        Math.max(this.radius * 0.01, Math.min(this.radius * 50, value));
      this.distance = limit(this.distance * factor);
      this.request();
    }

    // By pixels of the canvas.
    pan(right, down) {
      const back = this.direction();
      const side = unit(cross(this.up, back));
      const top = cross(back, side);
      const scale =
        (2 * this.distance * Math.tan(FIELD_OF_VIEW / 2)) /
        Math.min(this.canvas.clientWidth, this.canvas.clientHeight);
      this.target = add(this.target, side, -right * scale);
      this.target = add(this.target, top, down * scale);
      this.request();
    }

    request() {
      if (!this.pending) {
        this.pending = true;
        requestAnimationFrame(() => {
          this.pending = false;
          this.draw();
        });
      }
    }

    draw() {
      const { gl, canvas } = this;
      const ratio = Math.min(window.devicePixelRatio || 1, 2);
      const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
      const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
      if (canvas.width !== width || canvas.height !== height) {
        canvas.width = width;
        canvas.height = height;
      }
      gl.viewport(0, 0, width, height);
      gl.clearColor(...BACKGROUND, 1);
      gl.enable(gl.DEPTH_TEST);
      gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
      const cloud = this.clouds[this.shown];
      if (!cloud || cloud.count === 0 || !this.target) {
        return;
      }
      const near = Math.max(this.distance * 0.01, this.radius * 0.001);
      const far = this.distance + this.radius * 100;
      const shorter = Math.min(width, height);
      const focal = 1 / Math.tan(FIELD_OF_VIEW / 2);
      const projection = [
        (focal * shorter) / width, 0, 0, 0,
        0, (focal * shorter) / height, 0, 0,
        0, 0, (far + near) / (near - far), -1,
        0, 0, (2 * far * near) / (near - far), 0,
      ];
      const back = this.direction();
      const side = unit(cross(this.up, back));
      const top = cross(back, side);
      const eye = add(this.target, back, this.distance);
      const view = [
        side[0], top[0], back[0], 0,
        side[1], top[1], back[1], 0,
        side[2], top[2], back[2], 0,
        -dot(side, eye), -dot(top, eye), -dot(back, eye), 1,
      ];
      const uniform = (name) => gl.getUniformLocation(this.program, name);
      gl.useProgram(this.program);
      gl.uniformMatrix4fv(uniform("view"), false, view);
      gl.uniformMatrix4fv(uniform("projection"), false, projection);
      // As large as the points are apart where they cover the scene evenly.
      const spacing = (2.8 * this.radius) / Math.sqrt(cloud.count);
      gl.uniform1f(
        uniform("size"),
        (this.pointSize * spacing * focal * shorter) / 2
      );
      gl.bindBuffer(gl.ARRAY_BUFFER, cloud.positions);
      gl.enableVertexAttribArray(0);
      gl.vertexAttribPointer(0, 3, gl.FLOAT, false, 0, 0);
      gl.bindBuffer(gl.ARRAY_BUFFER, cloud.colors);
      gl.enableVertexAttribArray(1);
      gl.vertexAttribPointer(1, 3, gl.UNSIGNED_BYTE, true, 0, 0);
      gl.uniform1f(uniform("brightness"), 1);
      if (!this.parts) {
        gl.drawArrays(gl.POINTS, 0, cloud.count);
        return;
      }
      (this.showsBacks ? gl.disable : gl.enable).call(gl, gl.CULL_FACE);
      for (const { first, count, brightness } of this.parts) {
        gl.uniform1f(uniform("brightness"), brightness);
        gl.drawArrays(gl.TRIANGLES, first, count);
      }
    }

    listen() {
      const { canvas } = this;
      const pointers = new Map();
      const middle = () => {
        const all = [...pointers.values()];
        return [0, 1].map(
          (k) => all.reduce((sum, at) => sum + at[k], 0) / all.length
        );
      };
      const spread = () => {
        const [a, b] = [...pointers.values()];
        return b ? Math.hypot(a[0] - b[0], a[1] - b[1]) : 0;
      };
      canvas.addEventListener("pointerdown", (event) => {
        canvas.setPointerCapture(event.pointerId);
        pointers.set(event.pointerId, [event.clientX, event.clientY]);
        canvas.focus({ preventScroll: true });
      });
      const release = (event) => pointers.delete(event.pointerId);
      canvas.addEventListener("pointerup", release);
      canvas.addEventListener("pointercancel", release);
      canvas.addEventListener("pointermove", (event) => {
        if (!pointers.has(event.pointerId) || !this.target) {
          return;
        }
        const from = middle();
        const before = spread();
        pointers.set(event.pointerId, [event.clientX, event.clientY]);
        const to = middle();
        const [right, down] = [to[0] - from[0], to[1] - from[1]];
        if (pointers.size === 1 && event.buttons === 1 && !event.shiftKey) {
          this.rotate(right * 0.006, down * 0.006);
          return;
        }
        this.pan(right, down);
        if (before > 0 && spread() > 0) {
          this.zoom(before / spread());
        }
      });
      canvas.addEventListener("contextmenu", (event) => event.preventDefault());
      // Only once it was clicked, so that the page can be scrolled past it.
      canvas.addEventListener(
        "wheel",
        (event) => {
          if (document.activeElement === canvas && this.target) {
            event.preventDefault();
            this.zoom(Math.exp(Math.sign(event.deltaY) * 0.12));
          }
        },
        { passive: false }
      );
      canvas.addEventListener("keydown", (event) => {
        const turn = 0.08;
        const actions = {
          ArrowLeft: () => this.rotate(-turn, 0),
          ArrowRight: () => this.rotate(turn, 0),
          ArrowUp: () => this.rotate(0, -turn),
          ArrowDown: () => this.rotate(0, turn),
          "+": () => this.zoom(0.9),
          "-": () => this.zoom(1.1),
          Home: () => this.frame(this.shown),
        };
        if (actions[event.key] && this.target) {
          event.preventDefault();
          actions[event.key]();
        }
      });
    }
  }

  // What PointScript() of the program encodes.
  function decode(text) {
    const letters = atob(text);
    const bytes = new Uint8Array(letters.length);
    for (let i = 0; i < letters.length; ++i) {
      bytes[i] = letters.charCodeAt(i);
    }
    const count = bytes.length / 15; // Three floats and three bytes each.
    return {
      positions: new Float32Array(bytes.buffer, 0, 3 * count),
      colors: bytes.subarray(12 * count),
    };
  }

  // Loads data/points_NAME.js, which calls tsarPoints(NAME, ...).
  const loading = {};
  window.tsarPoints = (name, text) => loading[name](decode(text));
  function load(name) {
    return new Promise((resolve, reject) => {
      loading[name] = resolve;
      const script = document.createElement("script");
      script.src = `data/points_${name}.js`;
      script.onerror = () => reject(new Error(`${script.src} is missing`));
      document.head.append(script);
    });
  }

  return { View, load };
})();
