// Starts the page: theme, session, connection.
import "./app/app";
import { exchangeToken } from "./engine/session";

void exchangeToken();
