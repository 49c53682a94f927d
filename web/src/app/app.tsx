/** The whole page. */

export function App() {
  return <main>RAFCON</main>;
}
