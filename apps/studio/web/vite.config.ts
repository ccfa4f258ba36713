import react from "@vitejs/plugin-react";
import { defineConfig } from "vite";

// The server's content security policy allows scripts of its own only, so nothing is inlined.
export default defineConfig({
  plugins: [react()],
  build: { assetsInlineLimit: 0, chunkSizeWarningLimit: 1500 },
});
