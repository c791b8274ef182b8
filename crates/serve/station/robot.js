/** @typedef {any} Robot */
/** @typedef {any} State */
export {};
