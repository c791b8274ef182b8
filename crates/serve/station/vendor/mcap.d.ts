// Bundled by vendor.sh; tsc reads its types here. Its module alone: the package's index brings writers and their sorting.
export { default } from '@mcap/core/dist/esm/McapStreamReader.js';
