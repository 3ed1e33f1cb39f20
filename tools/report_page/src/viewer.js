// The view of a model in 3D: input, cage, wires, distance by colour, section. Draws when something has changed only.
import {interpolateViridis} from 'd3-scale-chromatic';
import {AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, Group, LineBasicMaterial,
        LineSegments, Mesh, MeshBasicMaterial, MeshLambertMaterial, PerspectiveCamera, Plane, Scene, Vector3,
        WebGLRenderer, WireframeGeometry} from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {contour, readModel} from './model.js';

const colours = {background: '#ffffff', input: '#dcae78', cage: '#7fa9d6', wires: '#14213a', inputWires: '#7a5a32',
                 inputContour: '#b0651a', cageContour: '#0b4a94'};

export const scaleColour = part => interpolateViridis(part);

/** Drawn as if it were this little farther away: wires lie on faces, and the cage may be that close to the input. */
const behind = steps => ({polygonOffset: true, polygonOffsetFactor: steps, polygonOffsetUnits: steps});

function geometryOf({positions, triangles}) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new BufferAttribute(positions, 3));
  geometry.setIndex(new BufferAttribute(triangles, 1));
  return geometry;
}

function colouredGeometry(surface) {
  const table = Array.from({length: 256}, (_, i) => new Color(scaleColour(i / 255)));
  const values = new Float32Array(3 * surface.distances.length);
  surface.distances.forEach((part, i) => table[Math.round(255 * part)].toArray(values, 3 * i));
  const geometry = geometryOf(surface);
  geometry.setAttribute('color', new BufferAttribute(values, 3));
  return geometry;
}

export class Viewer {
  /** Throws if there is no WebGL. */
  constructor(canvas) {
    this.canvas = canvas;
    this.renderer = new WebGLRenderer({canvas, antialias: true});
    this.renderer.localClippingEnabled = true;
    this.camera = new PerspectiveCamera(35, 1, 0.02, 12);
    this.scene = new Scene();
    this.scene.background = new Color(colours.background);
    this.model = new Group();
    this.scene.add(new AmbientLight('#ffffff', 1.6), this.model, this.camera);
    const lamp = new DirectionalLight('#ffffff', 2.2);
    lamp.position.set(0.4, 0.8, 1);
    this.camera.add(lamp);
    this.orbit = new OrbitControls(this.camera, canvas);
    this.orbit.addEventListener('change', () => this.draw());
    new ResizeObserver(() => this.draw()).observe(canvas.parentElement);
  }

  /** `view`: which parts to show, and {axis, part} of a section or null. */
  show(contents, place, view) {
    this.remove();
    this.contents = contents;
    this.meshes = readModel(contents, place);
    this.parts = this.makeParts();
    this.model.add(...Object.values(this.parts));
    this.findBox();
    this.reset();
    this.update(view);
  }

  remove() {
    this.model.traverse(({geometry, material}) => {
      geometry?.dispose();
      material?.dispose();
    });
    this.model.clear();
  }

  makeParts() {
    const {input, cage, surface} = this.meshes;
    const parts = {
      input: new Mesh(geometryOf(input), new MeshLambertMaterial({color: colours.input, flatShading: true,
                                                                  ...behind(2)})),
      inputWires: this.wires(input, colours.inputWires),
      inputContour: this.lines(new BufferGeometry(), colours.inputContour),
    };
    if (!cage) return parts;
    return {
      ...parts,
      cage: new Mesh(geometryOf(cage), new MeshLambertMaterial({color: colours.cage, flatShading: true,
                                                                transparent: true, opacity: 0.4, depthWrite: false})),
      distance: new Mesh(colouredGeometry(surface), new MeshBasicMaterial({vertexColors: true, ...behind(1)})),
      wires: this.wires(cage, colours.wires),
      cageContour: this.lines(new BufferGeometry(), colours.cageContour),
    };
  }

  wires(mesh, color) { return this.lines(new WireframeGeometry(geometryOf(mesh)), color); }
  lines(geometry, color) { return new LineSegments(geometry, new LineBasicMaterial({color})); }

  findBox() {
    const {positions} = this.meshes.cage ?? this.meshes.input;
    this.lower = [Infinity, Infinity, Infinity];
    this.upper = [-Infinity, -Infinity, -Infinity];
    positions.forEach((x, i) => {
      this.lower[i % 3] = Math.min(this.lower[i % 3], x);
      this.upper[i % 3] = Math.max(this.upper[i % 3], x);
    });
  }

  reset() {
    const lower = new Vector3(...this.lower);
    const upper = new Vector3(...this.upper);
    const radius = upper.distanceTo(lower) / 2;
    this.orbit.target.copy(lower).add(upper).multiplyScalar(0.5);
    const away = radius / Math.sin(this.camera.fov / 2 * Math.PI / 180) * 1.05;
    this.camera.position.set(0.55, 0.4, 0.8).normalize().multiplyScalar(away).add(this.orbit.target);
    this.orbit.update();
    this.draw();
  }

  update({input, inputWires, cage, wires, distance, section}) {
    const planes = section ? [this.plane(section)] : [];
    const visible = {input, inputWires, cage: cage && !distance, distance: cage && distance, wires,
                     inputContour: Boolean(section) && (input || inputWires),
                     cageContour: Boolean(section) && (cage || wires)};
    for (const [name, part] of Object.entries(this.parts)) {
      part.visible = visible[name];
      part.material.side = DoubleSide;  // what a section opens is seen from inside, too
      part.material.clippingPlanes = name.endsWith('Contour') ? [] : planes;
    }
    if (section) this.cutContours(section);
    this.draw();
  }

  /** Where on its axis a section is: at that part of the box. */
  offset({axis, part}) { return this.lower[axis] + part * (this.upper[axis] - this.lower[axis]); }

  /** What is beyond it is cut away. */
  plane(section) {
    const normal = new Vector3().setComponent(section.axis, -1);
    return new Plane(normal, this.offset(section));
  }

  cutContours(section) {
    for (const [name, mesh] of [['inputContour', this.meshes.input], ['cageContour', this.meshes.cage]]) {
      if (!mesh) continue;
      this.parts[name].geometry.dispose();
      this.parts[name].geometry = new BufferGeometry();
      const ends = contour(mesh, section.axis, this.offset(section));
      this.parts[name].geometry.setAttribute('position', new BufferAttribute(ends, 3));
    }
  }

  draw() {
    const {clientWidth, clientHeight} = this.canvas;
    if (clientWidth === 0 || clientHeight === 0) return;
    this.renderer.setPixelRatio(window.devicePixelRatio);
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scene, this.camera);
  }
}
