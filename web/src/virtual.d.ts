declare module 'virtual:mountain' {
  /** Heights of a grid, row by row from the north, metres. */
  const heights: { columns: number; rows: number; metres: number[] };
  export default heights;
}
