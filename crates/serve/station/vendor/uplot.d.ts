// Bundled by vendor.sh; tsc reads its types here.
export { default } from 'uplot';
