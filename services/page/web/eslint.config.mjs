import js from "@eslint/js";
import typescript from "typescript-eslint";

export default typescript.config(js.configs.recommended, ...typescript.configs.strict, {
  ignores: ["src/messages/generated.ts"],
}, {
  rules: {
    eqeqeq: "error",
    "no-restricted-properties": ["error", { property: "innerHTML", message: "Texts become text nodes, never markup." }],
    "@typescript-eslint/no-non-null-assertion": "off",
  },
});
