// Bundles the page of `prcage report` into one HTML file: node bundle.mjs DIRECTORY_OF_PACKAGES OUTPUT
//
// The page may run its own script and nothing else, and may ask nobody for anything: its content security policy names
// the script by its hash. The program puts the data where "<!--data-->" stands.
import {createHash} from 'node:crypto';
import {existsSync, readdirSync, readFileSync, renameSync, writeFileSync} from 'node:fs';
import {createRequire} from 'node:module';
import {dirname, join} from 'node:path';
import {fileURLToPath} from 'node:url';

const [packages, output] = process.argv.slice(2);
const modules = join(packages, 'node_modules');
const source = join(dirname(fileURLToPath(import.meta.url)), 'src');
const esbuild = createRequire(join(modules, 'x'))('esbuild');

function build(entry) {
  return esbuild.buildSync({
    entryPoints: [join(source, entry)],
    bundle: true,
    minify: true,
    format: 'iife',
    target: 'es2022',
    charset: 'ascii',  // the same bytes for every encoding the page may be taken for
    legalComments: 'none',  // the licences stand at the end of the page
    nodePaths: [modules],
    absWorkingDir: modules,
    outdir: '.',
    write: false,
    metafile: true,
    logLevel: 'warning',
  });
}

function packageOf(input) {
  const path = input.split('node_modules/').pop();
  return path.split('/').slice(0, path.startsWith('@') ? 2 : 1).join('/');
}

function licenceOf(name) {
  const directory = join(modules, name);
  const {version, license} = JSON.parse(readFileSync(join(directory, 'package.json'), 'utf8'));
  const file = readdirSync(directory).find(entry => /^licen[cs]e/i.test(entry));
  const text = file ? readFileSync(join(directory, file), 'utf8').trim() : license;
  return `${name} ${version}\n\n${text}`;
}

function licences(results) {
  const inputs = results.flatMap(result => Object.keys(result.metafile.inputs));
  const names = new Set(inputs.map(packageOf).filter(name => existsSync(join(modules, name, 'package.json'))));
  return [...names].sort().map(licenceOf).join('\n\n----------------\n\n');
}

const escaped = text => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;');

const script = build('main.js');
const style = build('page.css');
const code = script.outputFiles[0].text;
const parts = {
  policy: `default-src 'none'; style-src 'unsafe-inline'; img-src data: blob:; ` +
      `script-src 'sha256-${createHash('sha256').update(code).digest('base64')}'`,
  style: style.outputFiles[0].text,
  script: `<script>${code}</script>`,
  licences: escaped(licences([script, style])),
};
// The replacements are functions because "$" in a text would be a pattern.
const page = readFileSync(join(source, 'page.html'), 'utf8')
    .replaceAll(/<!--(policy|style|script|licences)-->/g, (_, name) => parts[name]);
writeFileSync(`${output}.tmp`, page);
renameSync(`${output}.tmp`, output);
