import "@fontsource-variable/inter/wght.css";
import "@mantine/core/styles.css";
import "./app/styles.css";
import { createRoot } from "react-dom/client";
import { App } from "./app/App";
import { preloadReview } from "./app/LoadedReview";

const root = document.getElementById("root");
void preloadReview(window.location.pathname).then(() => root && createRoot(root).render(<App />));
